# SPDX-License-Identifier: MIT
"""rbd-identify: simulated logs, of which the truth is known."""
import csv
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import rbd
from rbd import _identify, _identify_log
from rbd import _identifying as tool

URDF = rbd.SOURCES / "models/iiwa.urdf"
COULOMB, VISCOUS = np.array([3, 4, 2, 2.5, 1, 0.8, 0.4]), np.array([1, 1.5, 0.8, 1, 0.4, 0.3, 0.1])
OFFSET, NOISE, DT = np.array([0.1, -0.2, 0.05, 0.1, 0, -0.05, 0.02]), 0.1, 0.005


@pytest.fixture(scope="module")
def robots(double):
    """As described, and the true one, of other masses."""
    random = np.random.default_rng(3)
    urdf = rbd.load_urdf(URDF)
    bodies = []
    for body in urdf.bodies:
        factor = random.uniform(0.8, 1.25)
        bodies.append(replace(body, mass=body.mass * factor, inertia=tuple(factor * x for x in body.inertia),
                              com=tuple(x + random.uniform(-0.01, 0.01) for x in body.com)))
    return rbd.Model(urdf, library=double), rbd.Model(bodies, gravity=urdf.gravity, library=double)


def motion(n, seed):
    """Sums of five sines with a common period, which all joints have in other shares."""
    random, t = np.random.default_rng(seed), DT * np.arange(n)[:, None, None]
    rate = 2 * np.pi * 0.1 * np.arange(1, 6)[None, None, :]
    a, b = random.uniform(-0.4, 0.4, (2, 1, 7, 5))
    q = (a * np.sin(rate * t) + b * np.cos(rate * t)).sum(axis=2)
    v = (rate * (a * np.cos(rate * t) - b * np.sin(rate * t))).sum(axis=2)
    acceleration = (-rate ** 2 * (a * np.sin(rate * t) + b * np.cos(rate * t))).sum(axis=2)
    return q, v, acceleration


def write_log(path, truth, seed, n=4000, noise=NOISE, move=lambda q, v, a: (q, v, a), header=None):
    q, v, a = move(*motion(n, seed))
    random = np.random.default_rng(seed + 100)
    tau = truth.rnea(q, v, a) + COULOMB * np.sign(v) + VISCOUS * v + OFFSET + noise * random.normal(size=q.shape)
    names = truth.dof_names
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header or ["time", *(f"q:{x}" for x in names), *(f"tau:{x}" for x in names)])
        measured = q + 1e-6 * random.normal(size=q.shape)
        writer.writerows(np.column_stack([DT * np.arange(n), measured, tau]).tolist())
    return path


def test_a_simulated_log_gives_its_truth(robots, tmp_path, capsys):
    described, truth = robots
    log, other = write_log(tmp_path / "log.csv", truth, 1), write_log(tmp_path / "other.csv", truth, 2)
    options = tool.parse([str(URDF), str(log), "--validate", str(other), "--out", str(tmp_path / "found")])
    found = tool.run(options)
    assert not found.unknown
    assert np.abs(found.friction[:, 0] - COULOMB).max() < 0.1
    assert np.abs(found.friction[:, 1] - VISCOUS).max() < 0.1
    assert np.abs(found.friction[:, 2] - OFFSET).max() < 0.05

    # base parameters: within their confidence, and far nearer than the description
    independent, combinations = _identify.structure_of(truth)
    pi = np.concatenate([truth.body_parameters(k) for k in range(truth.nb)])
    off = np.abs(found.base - combinations @ pi) / found.base_deviation
    assert np.median(off) < 1.5 and np.mean(off < 3) > 0.9
    assert len(independent) == len(found.base) == np.linalg.matrix_rank(
        described.regressor(*np.random.default_rng(0).uniform(-2, 2, (3, 300, 7))).reshape(-1, 70), tol=1e-7)

    # each body exists, and the file has them: it predicts the other log to the noise
    for body in found.parameters:
        described.library.check_parameters(body)
    again = rbd.Model.from_urdf(tmp_path / "found/identified.urdf")
    q, v, a = motion(2000, 2)
    rest = truth.rnea(q, v, a) - again.rnea(q, v, a)
    wrong = truth.rnea(q, v, a) - described.rnea(q, v, a)
    assert (np.sqrt((rest ** 2).mean(axis=0)) < 0.05).all()
    assert np.sqrt((rest ** 2).mean()) < 0.02 * np.sqrt((wrong ** 2).mean())
    body = again.describe(again.joint_names.index(found.joints[1]))
    assert body.friction[0] == pytest.approx(found.friction[1, 0], rel=1e-6)
    assert body.damping[0] == pytest.approx(found.friction[1, 1], rel=1e-6)
    table = rbd.Model(rbd.load_table(tmp_path / "found/identified.h"))
    assert np.allclose(table.rnea(q, v, a), again.rnea(q, v, a), atol=1e-6)
    assert "<polyline" in (tmp_path / "found/residuals.svg").read_text()
    rows = list(csv.DictReader(open(tmp_path / "found/base_parameters.csv")))
    assert len(rows) == len(found.base) and all(float(r["low"]) < float(r["found"]) < float(r["high"]) for r in rows)
    assert found.joints[0] in capsys.readouterr().out


def test_currents_and_a_part_as_judge(robots, tmp_path):
    _, truth = robots
    names = truth.dof_names
    log = write_log(tmp_path / "log.csv", truth, 1, n=2000, header=[
        "time", *(f"q:{x}" for x in names), f"current:{names[0]}", *(f"tau:{x}" for x in names[1:])])
    with pytest.raises(tool.IdentifyError, match=f"'{names[0]}' has currents: give --constant"):
        tool.run(tool.parse([str(URDF), str(log), "--out", str(tmp_path)]))
    found = tool.run(tool.parse([str(URDF), str(log), "--out", str(tmp_path), "--constant", f"{names[0]}=1"]), str)
    assert abs(found.friction[0, 0] - 3) < 0.15


def test_a_log_without_excitation_names_what_it_lacks(robots, tmp_path):
    _, truth = robots

    def only(joint):
        def move(q, v, a):
            mask = np.arange(7) == joint
            return np.where(mask, q, 0.3), v * mask, a * mask
        return move

    log = write_log(tmp_path / "log.csv", truth, 1, n=2000, move=only(3))
    with pytest.raises(tool.IdentifyError, match="log.csv: joint '.*' moves faster than 0.02 rad/s in 0 samples only"):
        tool.run(tool.parse([str(URDF), str(log), "--out", str(tmp_path)]), str)

    def together(q, v, a):  # one joint after the other has the same motion: only some sums are told
        return q[:, :1] * np.ones(7) * 0.01, v[:, :1] * np.ones(7) * 0.01, a[:, :1] * np.ones(7) * 0.01

    log = write_log(tmp_path / "log.csv", truth, 1, n=2000, move=together)
    said = []
    found = tool.run(tool.parse([str(URDF), str(log), "--out", str(tmp_path), "--slow", "0.0001"]), said.append)
    assert found.unknown and any("not enough excitation" in line and found.unknown[0] in line for line in said)
    for body in found.parameters:
        truth.library.check_parameters(body)


def scale(rows, columns, factor):
    for row in rows[1:]:
        row[columns] = [float(x) * factor for x in row[columns]]


def with_speeds(rows, factor):
    """A column v: of the first joint, the slope of its positions times a factor."""
    slope = np.gradient([float(row[1]) for row in rows[1:]], DT)
    rows[0].append("v:" + rows[0][1][2:])
    for row, v in zip(rows[1:], slope):
        row.append(v * factor)


@pytest.mark.parametrize("change, message", [
    (lambda rows: rows[0].__setitem__(8, "tua:" + rows[0][8][4:]), r"unknown column 'tua:.*': did you mean 'tau:"),
    (lambda rows: [row.pop(3) for row in rows], r"joint '.*_3' has no column 'q:.*_3'. If it stood still, say where: --without"),
    (lambda rows: [row.__delitem__(slice(3, 5)) for row in rows], r"joint '.*_3' has no column 'q:.*_3'; the same of '.*_4'. If"),
    (lambda rows: [row.pop(8) for row in rows], r"needs either a column 'tau:.*' or 'current:"),
    (lambda rows: rows[17].__setitem__(4, "nan"), r"row 18, column 'q:.*': nan is not finite"),
    (lambda rows: rows[17].__setitem__(4, "x"), r"row 18, column 'q:.*': 'x' is no number"),
    (lambda rows: rows[17].pop(), r"row 18: 14 values, but the header has 15 columns"),
    (lambda rows: rows[50].__setitem__(0, float(rows[50][0]) - 0.003),
     r"row 51: a step of 0.002 s; the others have 0.005 s. Resample the log; or give --dt"),
    (lambda rows: rows[50].__setitem__(0, "0.1"), r"row 51: a step of -0.14 s; the others have 0.005 s"),
    (lambda rows: rows.__delitem__(slice(60, 180, 3)), r"59 samples are too few for a window of 21: .* least. .*row 61: a step of "
                                                       r"0.01 s; the others have 0.005 s. 40 gaps: 59 of 160 samples"),
    (lambda rows: rows[0].__setitem__(2, rows[0][1]), r"column 'q:.*' stands twice"),
    (lambda rows: [row.pop(0) for row in rows], r"no column 'time': give --dt"),
    (lambda rows: rows.__delitem__(slice(30, None)), r"29 samples are too few"),
    (lambda rows: rows.__delitem__(slice(1, None)), r"no samples"),
    (lambda rows: (rows.insert(3, []), rows[20].__setitem__(4, "")), r"row 21, column 'q:.*': '' is no number"),
    (lambda rows: rows[0].__setitem__(3, "position:" + rows[0][3][2:]), r"unknown column 'position:.*'; columns are time, and q:"),
    (lambda rows: scale(rows, slice(1, 8), 180 / np.pi), r"column 'q:.*' reaches .*limits are -.* rad: is it in degrees\?"),
    (lambda rows: scale(rows, slice(9, 10), 1000), r"torque of joint '.*_2' is .* N m and more in half of the log, but the joint's "
                                                   r"limit is 300: is the current in mA, or --constant of another unit\?"),
    (lambda rows: scale(rows, slice(0, 1), 1000), r"column 'time' grows by 5 a row: is it in milliseconds\?"),
    (lambda rows: with_speeds(rows, 180 / np.pi), r"column 'v:.*' is 57\.\d+ times the slope of column 'q:.*'"),
    (lambda rows: rows[0].__setitem__(slice(8, 15), ["current:" + x[4:] for x in rows[0][8:15]]),
     r"joint '.*_1' has currents: give --constant '.*_1=N m/A'; the same of '.*_2', .*'.*_7'"),
])
def test_a_bad_log_is_refused_by_name(robots, tmp_path, change, message, capsys):
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=200)
    with open(path) as file:
        rows = list(csv.reader(file))
    change(rows)
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows(rows)
    with pytest.raises(tool.IdentifyError, match=message):
        tool.run(tool.parse([str(URDF), str(path), "--out", str(tmp_path)]), str)
    assert tool.main([str(URDF), str(path), "--out", str(tmp_path)]) == 1
    assert capsys.readouterr().err.startswith("rbd-identify: ")


def identified(path, tmp_path, *words):
    """What is found in a log, and what is said of it."""
    said = []
    return tool.run(tool.parse([str(URDF), str(path), "--out", str(tmp_path / "found"), *words]), said.append), said


def change_log(path, change):
    with open(path) as file:
        rows = list(csv.reader(file))
    rows = change(rows) or rows
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows(rows)
    return path


def check_friction(found, joints=slice(None), close=0.15):
    truth = np.stack([COULOMB, VISCOUS, OFFSET], axis=1)
    assert np.abs(found.friction - truth)[joints].max() < close


def test_columns_may_stand_in_any_order(robots, tmp_path):
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=200)
    plain = tool.read_log(path, robots[0])
    order = np.random.default_rng(0).permutation(15)
    other = tool.read_log(change_log(path, lambda rows: [[row[k] for k in order] for row in rows]), robots[0])
    assert (plain.q == other.q).all() and (plain.tau == other.tau).all() and np.ptp(plain.tau) > 1


def test_gaps_part_the_log(robots, tmp_path):
    """It is filtered between them, as if there were several logs."""
    path = change_log(write_log(tmp_path / "log.csv", robots[1], 1, n=2000),
                      lambda rows: [row for k, row in enumerate(rows) if not 600 < k <= 800 and k != 1500])
    found, said = identified(path, tmp_path)
    assert f"{path}, row 602: a step of 1.005 s; the others have 0.005 s. 2 gaps: 1799 of 1799 samples" in said[0]
    check_friction(found)
    log = tool.read_log(path, robots[0], show=str)
    assert len(log.q) == 1799 - 3 * 20
    q, v, _ = motion(2000, 1)
    places = [k for begin, end in ((0, 600), (800, 1499), (1500, 2000)) for k in range(begin + 10, end - 10)]
    assert np.abs(log.q - q[places]).max() < 1e-4 and np.abs(log.v - v[places]).max() < 1e-3


def test_torques_that_are_cut_off_do_not_count(robots, tmp_path):
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=2000)

    def cut(rows):
        for row in rows[1:]:
            row[9] = max(-40.0, min(40.0, float(row[9])))

    found, said = identified(change_log(path, cut), tmp_path)
    assert "the torque of joint 'lbr_iiwa_joint_2' stands at its largest or least value, -40, in" in said[0]
    check_friction(found)


def test_a_wrong_sign_is_named(robots, tmp_path):
    """Of one motor, by a constant it is turned again; of an encoder, what is left tells."""
    path = change_log(write_log(tmp_path / "log.csv", robots[1], 1, n=2000), lambda rows: scale(rows, slice(11, 12), -1))
    with pytest.raises(tool.IdentifyError, match="the torque of joint '.*_4' fits friction and the description with the other sign "
                                                 "alone. Motor or encoder count the other way"):
        identified(path, tmp_path)
    found, said = identified(path, tmp_path, "--constant", "lbr_iiwa_joint_4=-1")
    check_friction(found)
    assert not any("look at" in line for line in said)
    change_log(path, lambda rows: (scale(rows, slice(11, 12), -1), scale(rows, slice(4, 5), -1)) and None)
    _, said = identified(path, tmp_path)
    assert any("look at joint 'lbr_iiwa_joint_4': " in line for line in said)


def test_torques_of_another_size_are_named(robots, tmp_path):
    """Currents in a column of torques: 8 N m/A."""
    path = change_log(write_log(tmp_path / "log.csv", robots[1], 1, n=2000), lambda rows: scale(rows, slice(8, 15), 1 / 8))
    said = []
    tool.read_log(path, robots[0], show=said.append)
    assert "the torques of joint 'lbr_iiwa_joint_2' are 0.1" in "".join(said) and "times what the description asks for" in said[0]


def test_joints_may_be_left_out(robots, tmp_path):
    """Two of seven in the log, the others stood still; their friction and what nothing tells stay as described."""
    described, truth = robots
    some, names = [1, 3], truth.dof_names

    def still(q, v, a):
        mask = np.isin(np.arange(7), some)
        return np.where(mask, q, 0.2), v * mask, a * mask

    path = write_log(tmp_path / "log.csv", truth, 1, n=2000, move=still)
    columns = [0, *(1 + i for i in some), *(8 + i for i in some)]
    change_log(path, lambda rows: [[row[k] for k in columns] for row in rows])
    words = [f"--without={names[i]}=0.2" for i in range(7) if i not in some]
    found, said = identified(path, tmp_path, *words)
    check_friction(found, some)
    assert sum(line.endswith("| not known") for line in said) == 5 and not any("look at" in line for line in said)
    assert np.isinf(found.friction_deviation[0]).all() and not found.friction[0].any()
    assert np.isfinite(found.friction_deviation[some]).all()
    assert np.isinf(found.base_deviation).sum() >= 20 and all(
        np.isinf(s) == (name in found.unknown) for name, s in zip(found.base_names, found.base_deviation))
    for body in found.parameters:
        truth.library.check_parameters(body)
    # what the log does tell holds: torques of these joints in another motion of theirs, by the file
    again = rbd.Model.from_urdf(tmp_path / "found/identified.urdf")
    q, v, a = still(*motion(2000, 2))
    rest = truth.rnea(q, v, a) - again.rnea(q, v, a)
    wrong = truth.rnea(q, v, a) - described.rnea(q, v, a)
    assert (np.sqrt((rest ** 2).mean(axis=0)) < 0.05 * np.sqrt((wrong ** 2).mean(axis=0)))[some].all()

    # of a joint that is logged and did not move
    path = write_log(tmp_path / "log.csv", truth, 1, n=2000, move=lambda q, v, a: tuple(
        np.where(np.arange(7) == 2, value, x) for value, x in ((0.3, q), (0, v), (0, a))))
    with pytest.raises(tool.IdentifyError, match="joint '.*_3' moves faster than .* If it stood still: --without '.*_3'"):
        identified(path, tmp_path)
    found, _ = identified(path, tmp_path, "--without", names[2])
    check_friction(found, [0, 1, 3, 4, 5, 6])


def test_a_quick_log_is_thinned(robots, tmp_path):
    """The filter makes neighbours alike: of a log of 1 kHz every ninth sample is as good, and a tenth of the work."""
    log = _identify.Log(*np.zeros((4, 900, 7)), steady=np.ones((900, 7), bool), together=_identify.together(101))
    thin = _identify_log.thinned(log)
    assert 27 < log.together < 30 and len(thin.q) == len(thin.steady) == 100 and thin.together == log.together / 9
    same = _identify_log.thinned(replace(log, together=_identify.together(21)))
    assert len(same.q) == 900


def test_a_part_of_the_joints_may_have_velocities(robots, tmp_path):
    """Those of a joint that has a column count, and the others are slopes."""
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=400)
    without = tool.read_log(path, robots[0])
    with open(path) as file:
        rows = list(csv.reader(file))
    with_speeds(rows, 1.25)
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows(rows)
    log = tool.read_log(path, robots[0])
    assert np.abs(log.v[:, 0] - 1.25 * without.v[:, 0]).max() < 0.01 * np.abs(without.v[:, 0]).max()
    assert np.abs(log.a[:, 0] - 1.25 * without.a[:, 0]).max() < 0.03 * np.abs(without.a[:, 0]).max()
    assert (log.v[:, 1:] == without.v[:, 1:]).all() and (log.a[:, 1:] == without.a[:, 1:]).all()


def test_a_log_that_is_too_quick_is_refused(robots, tmp_path):
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=200)
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([cell for name, cell in zip(rows[0], row) if name != "time"] for row in rows)
    with pytest.raises(tool.IdentifyError, match=r"log.csv: column 'q:.*_1' changes by .* in half of the log, but the joint's "
                                                 r"limit is .*: is it in degrees or mm, or the time in another unit\?"):
        tool.read_log(path, robots[0], tool.Reading(dt=DT / 50, window=0.1 / 50))


def test_files_of_spreadsheets(robots, tmp_path, capsys):
    """A byte order mark does no harm; other encodings and separators are named."""
    path = write_log(tmp_path / "log.csv", robots[1], 1, n=200)
    text, plain = path.read_text(), tool.read_log(path, robots[0])
    path.write_text(text, encoding="utf-8-sig")
    assert (tool.read_log(path, robots[0]).q == plain.q).all()
    for encoding, word, message in (("utf-16", ",", "log.csv: it is no text in UTF-8"),
                                    ("utf-8", ";", "log.csv, row 1: columns are parted by ';': part them by commas")):
        path.write_text(text.replace(",", word), encoding=encoding)
        assert tool.main([str(URDF), str(path), "--out", str(tmp_path)]) == 1
        assert message in capsys.readouterr().err


def test_a_picture_takes_any_name(tmp_path):
    path = tmp_path / "residuals.svg"
    tool.write_picture(path, ["left & <right>"], *np.random.default_rng(0).normal(size=(3, 50, 1)))
    texts = [text.text for text in ElementTree.parse(path).getroot().iter("{http://www.w3.org/2000/svg}text")]
    assert "left & <right>" in texts


@pytest.mark.parametrize("words, message", [
    (["--dt", "0.01", "--dt", "0.02"], "argument --dt: it stands twice"), (["--dt=1", "--dt", "1"], "argument --dt: it stands twice"),
    (["--wind", "1"], "unrecognized arguments: --wind 1"), (["--out", "a", "--out", "b"], "argument --out: it stands twice")])
def test_options_that_stand_twice_are_refused(words, message, capsys):
    with pytest.raises(SystemExit):
        tool.parse(["a.urdf", "a.csv", *words])
    assert message in capsys.readouterr().err
    assert tool.parse(["a.urdf", "a.csv", "--dt", "1", "--constant", "a=1", "--constant", "b=1"]).constant == ["a=1", "b=1"]


def test_joints_that_stand_twice_are_refused():
    for option, words in (("--constant", ["a=1", "b=2", "a=2"]), ("--without", ["a", "a=1"])):
        with pytest.raises(tool.IdentifyError, match=f"{option} '{words[-1]}': joint 'a' stands twice"):
            tool.pairs_of(option, words, "rad", bare=option == "--without")


def test_another_sample_time_than_logged_is_refused(robots, tmp_path):
    model, path = robots[0], tmp_path / "log.csv"
    q = motion(50, 1)[0]
    rows = [["time", *(f"{kind}:{joint}" for kind in ("q", "tau") for joint in model.dof_names)]]
    rows += [[DT * k, *q[k], *np.zeros(7)] for k in range(50)]
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(rows)
    with pytest.raises(tool.IdentifyError, match="--dt is 5 s, but column 'time' has steps of 0.005 s: leave out one"):
        tool.read_log(path, model, tool.Reading(dt=1000 * DT))


@pytest.mark.parametrize("words", [["--window", "0"], ["--window", "nan"], ["--dt", "0"], ["--dt", "x"], ["--slow", "-1"]])
def test_bad_numbers_of_the_command_are_refused(words, capsys):
    with pytest.raises(SystemExit):
        tool.main([str(URDF), "log.csv", *words])
    assert f"argument {words[0]}: '{words[1]}' is not a number above 0" in capsys.readouterr().err


def test_other_robots_and_words_are_refused(robots, tmp_path, capsys):
    assert tool.main([str(rbd.SOURCES / "models/five_bar.urdf"), str(tmp_path / "none.csv")]) == 1
    assert tool.main([str(URDF), str(tmp_path / "none.csv")]) == 1
    assert "none.csv: No such file or directory" in capsys.readouterr().err
    assert tool.main([str(rbd.SOURCES / "tests/mjcf/joints.xml"), str(tmp_path / "none.csv")]) == 1
    assert "takes URDF: rbd-model --urdf" in capsys.readouterr().err
    for word in "a", "a=nan", "a=0", "a=x":
        with pytest.raises(tool.IdentifyError, match=f"--constant '{word}': write JOINT=NUMBER"):
            tool.pairs_of("--constant", [word], "N m/A")
    log = write_log(tmp_path / "log.csv", robots[1], 1, n=200)
    with pytest.raises(tool.IdentifyError, match="--constant 'elbow': the robot has no joint of this name"):
        tool.read_log(log, robots[0], tool.Reading(constants={"elbow": 1}))
    with pytest.raises(tool.IdentifyError, match="--without 'elbow': the robot has no joint of this name"):
        tool.read_log(log, robots[0], tool.Reading(without={"elbow": None}))
    with pytest.raises(tool.IdentifyError, match="--without: no joint is left"):
        tool.run(tool.parse([str(URDF), str(log), *(f"--without={x}" for x in robots[0].dof_names), "--out", str(tmp_path)]), str)
    assert tool.pairs_of("--constant", ["a=b=2.5"], "") == {"a=b": 2.5}
    assert tool.pairs_of("--without", ["a", "b=0", "c=-1e-1"], "", bare=True) == {"a": None, "b": 0, "c": -0.1}
    with pytest.raises(tool.IdentifyError, match="--without 'b=x': write JOINT=NUMBER, in rad"):
        tool.pairs_of("--without", ["b=x"], "rad", bare=True)
