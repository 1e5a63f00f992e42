# rigid_body_dynamics.jl - RigidBodyDynamics.jl (https://github.com/JuliaRobotics/RigidBodyDynamics.jl) beside rbd:
#
#     rbd-bench --library rbd --variant run-time --algorithm ALGORITHM --samples SAMPLES --states --output STATES
#     julia --startup-file=no -O3 --check-bounds=no rigid_body_dynamics.jl MODELS EXPERIMENTS STATES...
#
# writes the rows of `rbd-bench --format csv` for its inverse dynamics, mass matrix and forward dynamics (by a Cholesky
# factor of the mass matrix: it has no ABA), without gravity. States, and what is computed of them, are rbd-bench's:
# a file for each of id, mm and fd. What differs: the mass matrix has one triangle.
# SPDX-License-Identifier: MIT
using LinearAlgebra, RigidBodyDynamics, Statistics

const CHUNK_NS, WARM_UP_CALLS, BOUND, MORE, REPEATS = 200_000, 1000, 1e-10, 2, 1.03
const COLUMNS = "library,version,compiler,scalar,robot,algorithm,samples,experiments,mean_ns,stddev_ns,min_ns," *
                "max_error,quad_error,variant,disturbed"
const TARGET = unsafe_string(Base.JLOptions().cpu_target)
const FLAGS = "julia $VERSION -O3 --check-bounds=no -C $TARGET"
const PROJECT = read(joinpath(dirname(dirname(pathof(RigidBodyDynamics))), "Project.toml"), String)
const PACKAGE_VERSION = match(r"^version *= *\"(.*)\""m, PROJECT)[1] # Julia 1.5 has no pkgversion

function die(text)
    println(stderr, "rigid_body_dynamics.jl: ", text)
    exit(1)
end

# ---- the file of rbd-bench ----

struct Block
    robot::String
    algorithm::String
    joints::Dict{String,Tuple{Int,Int}} # where each begins in q and v, from 0
    q::Matrix{Float64}                  # a state in each column, and so on
    v::Matrix{Float64}
    a::Matrix{Float64}
    tau::Matrix{Float64}
    result::Matrix{Float64}
end

function read_block(file)
    robot, algorithm, samples, nq, nv, results = split(readline(file))
    words = split.(split(readline(file), '\t', keepempty = false))
    joints = Dict(w[1] => (parse(Int, w[2]), parse(Int, w[3])) for w in words)
    array(numbers) = read!(file, Matrix{Float64}(undef, parse(Int, numbers), parse(Int, samples)))
    arrays = array.((nq, nv, nv, nv, results))
    Block(robot, algorithm, joints, arrays...)
end

function read_blocks(path)
    blocks = Block[]
    open(path) do file
        while !eof(file)
            push!(blocks, read_block(file))
        end
    end
    blocks
end

# ---- its conventions ----

# For each number of its q and of its v, the place in rbd's. The floating base has no name in the URDF file; in q it
# is w, x, y, z and then the position, in rbd the position and then x, y, z, w. v is the same.
function places(state, mechanism, block)
    named = block.joints
    base = setdiff(keys(named), [string(joint) for joint in joints(mechanism)])
    q, v = zeros(Int, num_positions(state)), zeros(Int, num_velocities(state))
    for joint in tree_joints(mechanism)
        iq, iv = get(() -> named[only(base)], named, string(joint))
        q_range, v_range = configuration_range(state, joint), velocity_range(state, joint)
        q[q_range] = isfloating(joint) ? iq .+ [7, 4, 5, 6, 1, 2, 3] : iq .+ (1:length(q_range))
        v[v_range] = iv .+ (1:length(v_range))
    end
    q, v
end

columns(x, rows) = [x[rows, k] for k in 1:size(x, 2)]

# ---- calls ----

# The states, in arrays of its own, and what is computed of them.
struct Robot{S,D,V}
    state::S
    result::D
    q::Vector{Vector{Float64}}
    v::Vector{Vector{Float64}}
    a::Vector{V}
    tau::Vector{Vector{Float64}}
    torques::V
    q_places::Vector{Int}
    v_places::Vector{Int}
end

function Robot(file, block)
    floating = size(block.q, 1) > size(block.v, 1)
    base = floating ? QuaternionFloating{Float64}() : Fixed{Float64}()
    mechanism = parse_urdf(file, root_joint_type = base, gravity = zeros(3))
    state = MechanismState(mechanism)
    q, v = places(state, mechanism, block)
    a = [copyto!(similar(velocity(state)), x) for x in columns(block.a, v)]
    Robot(state, DynamicsResult(mechanism), columns(block.q, q), columns(block.v, v), a, columns(block.tau, v),
          similar(velocity(state)), q, v)
end

function set!(r, k)
    copyto!(configuration(r.state), r.q[k])
    copyto!(velocity(r.state), r.v[k])
    setdirty!(r.state)
end

function id(r, k)
    set!(r, k)
    inverse_dynamics!(r.torques, r.result.jointwrenches, r.result.accelerations, r.state, r.a[k])
end

function mm(r, k)
    set!(r, k)
    mass_matrix!(r.result.massmatrix, r.state)
end

function fd(r, k)
    set!(r, k)
    dynamics!(r.result, r.state, r.tau[k])
end

const CALLS = Dict("id" => id, "mm" => mm, "fd" => fd)

# ---- whether it is right ----

result_of(::typeof(id), r) = r.torques[invperm(r.v_places)]
result_of(::typeof(fd), r) = r.result.v̇[invperm(r.v_places)]
result_of(::typeof(mm), r) = vec(Matrix(r.result.massmatrix)[invperm(r.v_places), invperm(r.v_places)])

function largest_error(call, r, block)
    worst = 0.0
    for k in 1:min(size(block.q, 2), 1000)
        call(r, k)
        expected = block.result[:, k]
        error = maximum(abs, result_of(call, r) - expected) / max(maximum(abs, expected), 1e-3)
        worst = error <= worst ? worst : error # keeps what is not a number
    end
    worst
end

bytes(call, r, k) = @allocated call(r, k)

# ---- time: as timing/measure.c ----

mutable struct Row{C,R}
    call::C
    r::R
    block::Block
    error::Float64
    chunks::Vector{UnitRange{Int}}
    times::Vector{Vector{Float64}} # of each chunk the least two
    whole::Vector{Float64}         # of each experiment
end

function time_of(row::Row, samples)
    begun = time_ns()
    for k in samples
        row.call(row.r, k)
    end
    Float64(time_ns() - begun)
end

function Row(block, r)
    call, n = CALLS[block.algorithm], size(block.q, 2)
    error = largest_error(call, r, block)
    error <= BOUND || die("$(block.robot), $(block.algorithm): relative error $error")
    bytes(call, r, 1)
    bytes(call, r, 1) == 0 || die("$(block.robot), $(block.algorithm): allocates $(bytes(call, r, 1)) bytes")
    row = Row(call, r, block, error, [1:n], [[Inf, Inf]], Float64[])
    time_of(row, 1:n)
    length_of_chunk = clamp(round(Int, CHUNK_NS * n / time_of(row, 1:n)), 1, n)
    row.chunks = [i:min(i + length_of_chunk - 1, n) for i in 1:length_of_chunk:n]
    row.times = [[Inf, Inf] for _ in row.chunks]
    row
end

function experiment!(row)
    n, sum = size(row.block.q, 2), 0.0
    time_of(row, 1:min(n, WARM_UP_CALLS))
    for (chunk, least) in zip(row.chunks, row.times)
        ns = time_of(row, chunk)
        sum += ns
        least[2] = min(least[2], max(ns, least[1]))
        least[1] = min(least[1], ns)
    end
    push!(row.whole, sum / n)
end

least(row, i) = sum(t[i] for t in row.times) / size(row.block.q, 2)
disturbed(row) = least(row, 2) > REPEATS * least(row, 1)

function print_row(row, experiments)
    whole = row.whole[1:experiments]
    println(join(["RigidBodyDynamics.jl", PACKAGE_VERSION, FLAGS, "double", row.block.robot, row.block.algorithm,
                  size(row.block.q, 2), experiments, mean(whole), experiments > 1 ? std(whole) : 0.0, least(row, 1),
                  row.error, "", "run-time", Int(experiments > 1 && disturbed(row))], ","))
end

function main(models, experiments, states)
    BLAS.set_num_threads(1)
    robots = Dict{String,Robot}()
    blocks = reduce(vcat, read_blocks.(states))
    rows = [Row(b, get!(() -> Robot(joinpath(models, b.robot * ".urdf"), b), robots, b.robot)) for b in blocks]
    GC.gc()
    for e in 1:experiments, row in rows
        experiment!(row)
    end
    for e in 1:(experiments > 1 ? MORE * experiments : 0), row in rows
        disturbed(row) && experiment!(row)
    end
    println(COLUMNS)
    foreach(row -> print_row(row, experiments), rows)
end

if ARGS == ["--version"]
    println("RigidBodyDynamics.jl $PACKAGE_VERSION, julia $VERSION")
    exit()
end
length(ARGS) >= 3 || (println(stderr, "usage: rigid_body_dynamics.jl MODELS EXPERIMENTS STATES..."); exit(2))
main(ARGS[1], parse(Int, ARGS[2]), ARGS[3:end])
