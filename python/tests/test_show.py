# SPDX-License-Identifier: MIT
"""Pages of a robot: the scene is the model's, shapes of the file stand where the file has them, and a browser draws them."""
import base64
import json
import pickle
import re
import shutil
import struct
import subprocess
import sys

import numpy as np
import pytest

import rbd

PYRAMID = np.array([[0, 0, 0.3], [0.1, 0.1, 0], [-0.1, 0.1, 0], [-0.1, -0.1, 0], [0.1, -0.1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
INERTIAL = ('<inertial><origin xyz="0 0 0.2"/><mass value="2"/>'
            '<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>')
ARM = f"""<robot name="arm"><material name="red"><color rgba="0.8 0.1 0.1 1"/></material>
<link name="base"><visual><geometry><cylinder radius="0.15" length="0.1"/></geometry><material name="red"/></visual></link>
<joint name="turn" type="continuous"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
<link name="upper">{INERTIAL}<visual><origin xyz="0 0 0.25"/><geometry><box size="0.1 0.2 0.5"/></geometry></visual>
  <visual><geometry><mesh filename="gone.dae"/></geometry></visual>
  <visual><geometry><mesh filename="../meshes/other.dae"/></geometry></visual></link>
<joint name="bend" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/></joint>
<link name="lower">{INERTIAL}<visual><origin xyz="0.3 0 0" rpy="0.1 0.2 0.3"/>
    <geometry><mesh filename="package://arm_description/meshes/binary.stl" scale="1 -2 1"/></geometry></visual>
  <visual><geometry><mesh filename="../meshes/text.stl"/></geometry></visual>
  <visual><geometry><mesh filename="file://../meshes/faces.obj"/></geometry></visual>
  <visual><geometry><sphere radius="0.08"/></geometry></visual></link>
<joint name="weld" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0 0 0.4" rpy="0 0 1.5707963267948966"/></joint>
<link name="tool"><visual><origin xyz="0.05 0 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></visual></link></robot>"""


def scene_of(picture):
    return json.loads(re.search(r"^const scene = (.*);$", picture.html, re.M)[1])


def numbers(text):
    return np.frombuffer(base64.b64decode(text), "<f4")


def places(scene, kind, body):
    """Shapes of a body, with 3 x 3 and position."""
    found = [item for item in scene["items"] if item["kind"] == kind and item["body"] == body]
    return [(item["shape"], np.reshape(item["place"][:9], (3, 3)), np.array(item["place"][9:]), item) for item in found]


@pytest.fixture
def arm_file(tmp_path):
    """A robot as packages of ROS have it, with meshes."""
    package = tmp_path / "arm_description"
    for name in ("urdf", "meshes"):
        (package / name).mkdir(parents=True)
    corners = PYRAMID[FACES]
    (package / "meshes/binary.stl").write_bytes(
        bytes(80) + struct.pack("<I", len(FACES)) + b"".join(struct.pack("<12f", 0, 0, 0, *c.ravel()) + b"\0\0" for c in corners))
    (package / "meshes/text.stl").write_text("solid a\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in c) + "endloop\nendfacet\n"
        for c in corners) + "endsolid a\n")
    (package / "meshes/faces.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in PYRAMID) + "f 1/1 2/2 3/3\nf 1//1 3//1 4//1\nf -5 -2 -1\nf 1 5 2\nf 2 3 4 5\n")
    (package / "meshes/other.dae").write_text("<COLLADA/>")
    path = package / "urdf/arm.urdf"
    path.write_text(ARM)
    return path


def test_scene_of_the_model(hyq, tmp_path):
    """Poses and the centre of mass are those of kinematics; rods join bodies; ellipsoids have the bodies' inertia."""
    q = hyq.random(3)
    q[:3] = 0.1, 0.2, 0.7
    picture = hyq.show(q, file=tmp_path / "page.html")
    assert picture.path.read_text() == picture.html and picture.html.count("<script") == 1
    assert not re.search(r"https?://|src=|@import", picture.html)  # nothing is asked of a server
    scene = scene_of(picture)
    hyq.kinematics(q)
    poses = numbers(scene["poses"]).reshape(hyq.nb, 12)
    for body, pose in enumerate(poses):
        R, p = hyq.body_pose(body)
        assert np.allclose(pose, [*R.ravel(), *p], atol=1e-6)
    assert np.allclose(numbers(scene["com"]), hyq.com().position, atol=1e-6)

    ends = [M @ [0, 0, 1] + p for _, M, p, _ in places(scene, "links", 0)]
    hips = [body.position for body in hyq.bodies if body.parent == 0]
    assert len(ends) == len(hips) == 4 and np.allclose(ends, hips)
    for number, body in enumerate(hyq.bodies):
        [(shape, M, p, _)] = places(scene, "inertias", number)
        xx, xy, xz, yy, yz, zz = body.inertia
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        spread = M @ M.T / 5 * body.mass  # second moments of a ball of this mass that the matrix deforms
        assert shape == "sphere" and np.allclose(p, body.com)
        assert np.allclose(np.trace(spread) * np.eye(3) - spread, inertia, rtol=1e-9, atol=1e-9)
    low, high = map(np.array, scene["box"])
    assert (poses[:, 9:] >= low - 1e-6).all() and (poses[:, 9:] <= high + 1e-6).all()


def test_motion(iiwa, tmp_path):
    """A motion is shown at even times, between the configurations as interpolate has it; long ones with fewer pictures."""
    Q, times = iiwa.random(5, n=4), np.array([1.0, 1.5, 1.6, 3.0])
    scene = scene_of(iiwa.show(Q, times, file=tmp_path / "a.html"))
    poses = numbers(scene["poses"]).reshape(-1, 7, 12)
    assert len(poses) == 121 and scene["start"] == 1 and scene["step"] == pytest.approx(1 / 60)
    for number, q in ((0, Q[0]), (30, Q[1]), (36, Q[2]), (120, Q[3]), (15, iiwa.interpolate(Q[0], Q[1], 0.5))):
        iiwa.kinematics(q)
        assert np.allclose(poses[number, 6, 9:], iiwa.body_pose(6).p, atol=1e-5)
    assert len(numbers(scene_of(iiwa.show(Q, 100 * times, file=tmp_path / "b.html"))["poses"])) == 1500 * 7 * 12
    assert len(numbers(scene_of(iiwa.show(Q, file=tmp_path / "c.html"))["poses"])) == 4 * 7 * 12
    iiwa.kinematics(Q[0])
    before = iiwa.body_pose(6).p
    iiwa.show(file=tmp_path / "d.html")  # neutral; what kinematics computed stays
    assert (iiwa.body_pose(6).p == before).all()


def test_shapes_of_the_file(arm_file, double, tmp_path):
    """Each shape stands in its link's body as the file says; what cannot be drawn is named; copies keep them."""
    model = rbd.Model.from_urdf(arm_file, library=double)
    scene = scene_of(model.show(file=tmp_path / "page.html"))
    assert [line.split(":")[0] for line in scene["missing"]] == ["Link 'upper'"] * 2
    assert "'gone.dae' is not there" in scene["missing"][0] and "'other.dae' is no Collada that can be drawn" in scene["missing"][1]
    assert not [item for item in scene["items"] if item["kind"] in ("links", "joints", "inertias")]

    [(shape, M, p, item)] = places(scene, "shapes", -1)  # the base is the world
    assert shape == "cylinder" and item["colour"] == [0.8, 0.1, 0.1, 1]
    assert np.allclose(M @ [1, 0, 0] + p, [0.15, 0, -0.05]) and np.allclose(M @ [0, 0, 1] + p, [0, 0, 0.05])
    [(shape, M, p, _)] = places(scene, "shapes", 0)
    assert shape == "box" and np.allclose(M, np.diag([0.1, 0.2, 0.5])) and np.allclose(p, [0, 0, 0.25])
    binary, text, faces, ball, tool = places(scene, "shapes", 1)
    cr, sr, cp, sp, cy, sy = (f(x) for x in (0.1, 0.2, 0.3) for f in (np.cos, np.sin))
    R = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]] @ [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    assert np.allclose(binary[1], R @ np.diag([1, -2, 1])) and np.allclose(binary[2], [0.3, 0, 0])
    for shape, _, _, _ in (binary, text, faces):
        corners = numbers(scene["meshes"][shape]).reshape(-1, 3, 3)
        assert np.allclose(corners[:4], PYRAMID[FACES])
    assert len(corners) == 6  # a face of four corners is two triangles
    assert ball[0] == "sphere" and np.allclose(ball[1], 0.08 * np.eye(3))
    assert np.allclose(tool[1], np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ np.diag([0.1, 0.2, 0.3]))
    assert np.allclose(tool[2], [0, 0.05, 0.4])

    for other in (model.copy(), pickle.loads(pickle.dumps(model)), model.lock_joints("turn", model.neutral())):
        assert scene_of(other.show(file=tmp_path / "copy.html"))["items"] == scene["items"]
    arm_file.unlink()  # rods, where the file has gone
    assert places(scene_of(model.show(file=tmp_path / "rods.html")), "links", 0)


COLLADA = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="15">{points}</float_array></source>
<source id="n"><float_array id="b" count="3">0 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>
<p>0 0 1 0 2 0 0 0 2 0 3 0</p></triangles>
<polylist count="2"><input semantic="NORMAL" source="#n" offset="0"/><input semantic="VERTEX" source="#v" offset="1"/>
<vcount>3 4</vcount><p>0 0 0 3 0 4 0 1 0 2 0 3 0 4</p></polylist></mesh></geometry></library_geometries>
<library_nodes><node id="part"><scale>2 2 2</scale><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="w"><node><matrix>1 0 0 10 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<node><translate>0 5 0</translate><rotate>0 0 1 90</rotate><instance_node url="#part"/></node></node></visual_scene></library_visual_scenes>
</COLLADA>"""


def test_collada(arm_file, double, tmp_path):
    """Triangles and polygons, where the nodes place them, in metres; axes as they stand in the file."""
    mesh = arm_file.parent.parent / "meshes/other.dae"
    mesh.write_text(COLLADA.format(points=" ".join(map(str, PYRAMID.ravel()))))
    scene = scene_of(rbd.Model.from_urdf(arm_file, library=double).show(file=tmp_path / "page.html"))
    corners = numbers(scene["meshes"]["../meshes/other.dae"]).reshape(-1, 3, 3)
    x, y, z = np.moveaxis(PYRAMID, 1, 0)
    placed = np.stack([10 - 2 * y, 5 + 2 * x, 2 * z], axis=1) / 100
    assert np.allclose(corners, placed[[[0, 1, 2], [0, 2, 3], [0, 3, 4], [1, 2, 3], [1, 3, 4]]], atol=1e-6)
    for wrong in ("<COLLADA", COLLADA.replace("#part", "#gone"), COLLADA.replace('url="#g"', 'url="#part"').format(points="0")):
        mesh.write_text(wrong)
        scene = scene_of(rbd.Model.from_urdf(arm_file, library=double).show(file=tmp_path / "page.html"))
        assert len(scene["missing"]) == 2 and "other.dae" in scene["missing"][1]


BOX = '<geometry><box size="1 1 1"/></geometry>'
WRONG = {  # a shape, and why it is not drawn
    '<geometry><box size="nan 1 1"/></geometry>': "size is 'nan 1 1'; it must have 3 numbers",
    '<geometry><box size="1e400 1 1"/></geometry>': "size is '1e400 1 1'; it must have 3 numbers",
    '<geometry><box size="1 1"/></geometry>': "size is '1 1'; it must have 3 numbers",
    '<geometry><sphere/></geometry>': "radius is ''; it must have 1 number",
    '<geometry><mesh filename="a" scale="1"/></geometry>': "the mesh 'a' is not there",
    '<origin xyz="1 2"/>' + BOX: "xyz is '1 2'; it must have 3 numbers",
    f'<geometry><mesh filename="{"a" * 5000}.stl"/></geometry>': "File name too long",
    '<geometry><mesh filename="words.obj"/></geometry>': "the mesh 'words.obj' cannot be read: could not convert",
    '<geometry><mesh filename="empty.obj"/></geometry>': "an OBJ without faces",
    '<geometry><mesh filename="flat.obj"/></geometry>': "the mesh 'flat.obj' has corners that are not three finite numbers",
    '<geometry><mesh filename="nan.stl"/></geometry>': "the mesh 'nan.stl' has corners that are not three finite numbers",
}


def test_what_is_wrong_is_named(double, tmp_path):
    """Shapes that nobody can draw are named, and the others are drawn; colours that are none are grey. Names stay text."""
    (tmp_path / "words.obj").write_text("v 0 0 x\nf 1 1 1\n")
    (tmp_path / "empty.obj").write_text("f 0 0 0\n")
    (tmp_path / "flat.obj").write_text("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n")
    (tmp_path / "nan.stl").write_text("solid a\nvertex nan 0 0\nvertex 0 1 0\nvertex 0 0 1\n")
    colours = ["a b c d", "1 0 0", "nan 0 0 1"]
    visuals = [*WRONG, *(f'{BOX}<material name="m{k}"><color rgba="{rgba}"/></material>' for k, rgba in enumerate(colours)),
               '<geometry><mesh filename="&lt;/script&gt;&lt;script&gt;.stl"/></geometry>']
    text = ARM[:ARM.index("<link")].replace("0.8 0.1 0.1 1", "red") + '<link name="base">' + "".join(
        f"<visual>{visual}</visual>" for visual in visuals) + "</link></robot>"
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    model = rbd.Model([rbd.Body("body", type="floating", mass=1, inertia=(1, 0, 0, 1, 0, 1))], library=double)
    model._drawn = path, [rbd.Frame("base", None, -1, 0, np.zeros(3), np.eye(3))], None

    picture = model.show(file=tmp_path / "page.html")
    scene = scene_of(picture)
    assert len(scene["missing"]) == len(WRONG) + 1 and picture.html.count("<script") == 1
    for sentence, expected in zip(scene["missing"], WRONG.values()):
        assert sentence.startswith("Link 'base': ") and expected in sentence
    assert [item["colour"] for _, _, _, item in places(scene, "shapes", 0)] == 3 * [[0.72, 0.75, 0.78, 1.0]]


def test_kinematic_robot(double, tmp_path):
    """One without masses has no centre of mass and no ellipsoids."""
    bodies = [rbd.Body("a", type="revolute", axis=(0, 0, 1)), rbd.Body("b", parent=0, type="prismatic", axis=(1, 0, 0), position=(1, 0, 0))]
    scene = scene_of(rbd.Model(bodies, kinematic=True, library=double).show([0.1, 0.2], file=tmp_path / "page.html"))
    assert scene["com"] is None and not [item for item in scene["items"] if item["kind"] == "inertias"]
    assert len(places(scene, "joints", 1)) == 1


def test_the_heading_is_the_robots_name(double, tmp_path):
    """That of a C table, of a robot without a file, or none."""
    table = rbd.load_table(rbd.SOURCES / "models/iiwa.h")
    assert type(pickle.loads(pickle.dumps(table))) is list and pickle.loads(pickle.dumps(table)) == list(table)
    model = rbd.Model(table, library=double)
    for robot, title in ((model, "iiwa"), (pickle.loads(pickle.dumps(model)), "iiwa"), (rbd.Model(table[:3], library=double), "A robot"),
                         (rbd.Model(rbd.parse_urdf(ARM), library=double), re.search('robot name="(.*?)"', ARM)[1])):
        page = robot.show(file=tmp_path / "page.html")
        assert scene_of(page)["title"] == title and f"<title>{title}</title>" in page.html


def test_where_it_is_seen(iiwa, tmp_path, monkeypatch):
    """In the browser; where there is none a warning names the file; in a notebook in place."""
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda uri: opened.append(uri) or True)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    picture = iiwa.show()
    assert opened == [picture.path.as_uri()] and str(picture.path) in repr(picture) and picture.path.parent == tmp_path
    monkeypatch.setattr("webbrowser.open", lambda uri: False)
    with pytest.warns(rbd.RbdWarning, match="no browser was found; the picture is in "):
        iiwa.show()
    monkeypatch.setitem(sys.modules, "ipykernel", None)
    notebook = iiwa.show()
    assert notebook.path is None and notebook._repr_html_().startswith("<iframe srcdoc=\"&lt;!doctype html&gt;")
    assert len(opened) == 1


def test_wrong_arguments(iiwa, tmp_path):
    file, q = tmp_path / "page.html", np.zeros(7)
    for arguments, words in (((np.zeros(6),), "q must have the shape"), ((np.full(7, np.nan),), r"q\[0\] is nan"),
                             ((np.zeros((0, 7)),), "no states"), ((q, [0.0]), "times are for a trajectory"),
                             (([q, q], [0.0]), "times must have the shape"), (([q, q], [1.0, 1.0]), "times must grow"),
                             (([q, q], [-1e308, 1e308]), "times are too far apart")):
        with pytest.raises(ValueError, match=f"^show: .*{words}|^show: {words}"):
            iiwa.show(*arguments, file=file)
    with pytest.raises(TypeError, match="^show: q is not an array of numbers"):
        iiwa.show([[0] * 7, [0] * 6], file=file)
    assert not file.exists()


def test_names_are_text(double, tmp_path):
    """A name of a file or link ends no element of the page."""
    path = tmp_path / "a&lt;<script>TITLE SCENE.urdf"
    path.write_text(ARM.replace("upper", "&lt;/script&gt;upper"))
    page = rbd.Model.from_urdf(path, library=double).show(file=tmp_path / "page.html").html
    assert page.count("<script") == page.count("</script") == 1 and "<title>a&amp;lt;&lt;script&gt;TITLE SCENE</title>" in page
    assert scene_of(rbd.Model.from_urdf(path, library=double).show(file=tmp_path / "page.html"))["title"] == path.stem


# Counts red and orange pixels of the page's picture, into its title.
COUNT = """<script>
draw();
const seen = new Uint8Array(4 * canvas.width * canvas.height), counts = [0, 0];
gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, seen);
for (let k = 0; k < seen.length; k += 4) {
  const [red, green, blue, opacity] = seen.subarray(k, k + 4);
  if (opacity > 250 && red > 70 && green < 0.3 * red && blue < 0.3 * red) counts[0]++;
  if (opacity > 250 && red > 70 && Math.abs(green - 0.58 * red) < 20 && blue < 0.4 * red) counts[1]++;
}
document.title = `red ${counts[0]} orange ${counts[1]}`;
</script></body>"""


@pytest.mark.skipif(not shutil.which("chromium"), reason="chromium is not installed")
def test_in_a_browser(arm_file, double, tmp_path):
    """It draws without a complaint: the base in red, and of the same robot without its file rods in orange."""
    model = rbd.Model.from_urdf(arm_file, library=double)

    def pixels():
        picture = model.show([[0.3, 0.8], [0.5, 0.8]], file=tmp_path / "page.html")
        picture.path.write_text(picture.html.replace("</body>", COUNT))
        done = subprocess.run(["chromium", "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
                               "--enable-unsafe-swiftshader", "--enable-logging=stderr", "--window-size=600,500",
                               f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", picture.path.as_uri()],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=True)
        complaints = [line for line in done.stderr.splitlines() if "CONSOLE" in line and "GPU stall" not in line]
        assert not complaints, complaints
        return map(int, re.search(r"<title>red (\d+) orange (\d+)</title>", done.stdout).groups())

    red, orange = pixels()
    assert red > 2000 and orange < 200
    arm_file.unlink()
    red, orange = pixels()
    assert red < 500 and orange > 500
