# rigid_body_dynamics.jl - RigidBodyDynamics.jl (https://github.com/JuliaRobotics/RigidBodyDynamics.jl) beside rbd:
#
#     julia --startup-file=no -O3 --check-bounds=no rigid_body_dynamics.jl MODELS SAMPLES EXPERIMENTS
#
# writes the rows of `rbd-bench --format csv` for its inverse dynamics, mass matrix and forward dynamics (by a Cholesky
# factor of the mass matrix: it has no ABA). What differs from rbd-bench: the states are its own random ones, gravity
# is on, the mass matrix has one triangle, and max_error is how well its own three results agree.
# SPDX-License-Identifier: MIT
using LinearAlgebra, Random, RigidBodyDynamics, Statistics

const CHUNK_NS = 200_000
const COLUMNS = "library,version,compiler,scalar,robot,algorithm,samples,experiments,mean_ns,stddev_ns,min_ns," *
                "max_error,quad_error,variant,disturbed"

struct Samples
    q::Vector{Vector{Float64}}
    v::Vector{Vector{Float64}}
    a::Vector{Vector{Float64}}
    tau::Vector{Vector{Float64}}
end

uniform(n, bound) = bound .* (2 .* rand(n) .- 1)

function draw(state, n)
    nv = num_velocities(state)
    q = [(rand_configuration!(state); Vector(configuration(state))) for _ in 1:n]
    Samples(q, [uniform(nv, 2) for _ in 1:n], [uniform(nv, 3) for _ in 1:n], [uniform(nv, 20) for _ in 1:n])
end

function set!(state, s, k)
    copyto!(configuration(state), s.q[k])
    copyto!(velocity(state), s.v[k])
    setdirty!(state)
end

# Calls of sample k, by name.
function calls(state, result, s)
    a, tau = similar(velocity(state)), similar(velocity(state))
    id(k) = (set!(state, s, k); copyto!(a, s.a[k]);
             inverse_dynamics!(tau, result.jointwrenches, result.accelerations, state, a); tau)
    mm(k) = (set!(state, s, k); mass_matrix!(result.massmatrix, state); result.massmatrix)
    fd(k) = (set!(state, s, k); dynamics!(result, state, s.tau[k]); result.v̇)
    (id = id, mm = mm, fd = fd)
end

# M a + c = tau, and forward dynamics of that tau is a.
function largest_error(c, s, n)
    relative(x, y) = maximum(abs, x - y) / max(maximum(abs, y), 1e-3)
    worst = 0.0
    for k in 1:n
        tau = Vector(c.id(k))
        a = copy(s.a[k])
        s.a[k] .= 0
        bias = Vector(c.id(k))
        s.a[k] .= a
        given = copy(s.tau[k])
        s.tau[k] .= tau
        worst = max(worst, relative(c.mm(k) * a + bias, tau), relative(Vector(c.fd(k)), a))
        s.tau[k] .= given
    end
    worst
end

function run(call, first, last)
    for k in first:last
        call(k)
    end
end

# As timing/measure.c: the least time of each chunk; disturbed if the second-least ones are more than 3 % above.
function measure(call, n, experiments)
    run(call, 1, n)
    start = time_ns()
    run(call, 1, n)
    chunk = clamp(round(Int, CHUNK_NS * n / (time_ns() - start)), 1, n)
    starts = 1:chunk:n
    times = [Float64[] for _ in starts]
    for _ in 1:experiments, (i, first) in enumerate(starts)
        begun = time_ns()
        run(call, first, min(first + chunk - 1, n))
        push!(times[i], time_ns() - begun)
    end
    whole = [sum(t[e] for t in times) / n for e in 1:experiments]
    foreach(sort!, times)
    least, second = sum(t[1] for t in times), sum(t[min(2, end)] for t in times)
    (mean(whole), experiments > 1 ? std(whole) : 0.0, least / n, second > 1.03 * least)
end

function main(models, samples, experiments)
    println(COLUMNS)
    for (robot, floating) in (("iiwa", false), ("hyq", true), ("atlas", true))
        file = joinpath(models, robot * ".urdf")
        mechanism = floating ? parse_urdf(file, root_joint_type = QuaternionFloating{Float64}()) : parse_urdf(file)
        state, result = MechanismState(mechanism), DynamicsResult(mechanism)
        Random.seed!(1)
        s = draw(state, samples)
        c = calls(state, result, s)
        error = largest_error(c, s, min(samples, 1000))
        error < 1e-8 || exit(1)
        for name in keys(c)
            average, deviation, least, disturbed = measure(c[name], samples, experiments)
            println(join(["RigidBodyDynamics.jl", pkgversion(RigidBodyDynamics), "julia $VERSION -O3 --check-bounds=no",
                          "double", robot, name, samples, experiments, average, deviation, least, error, "",
                          "run-time", Int(disturbed)], ","))
        end
    end
end

length(ARGS) == 3 || (println(stderr, "usage: rigid_body_dynamics.jl MODELS SAMPLES EXPERIMENTS"); exit(2))
main(ARGS[1], parse(Int, ARGS[2]), parse(Int, ARGS[3]))
