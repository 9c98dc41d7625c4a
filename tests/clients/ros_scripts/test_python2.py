"""Programs in Python 2: what they mean, and what cannot be read."""

import importlib
import sys

import pytest

from atlas_drake.clients.ros_scripts.program import Program
from atlas_drake.clients.ros_scripts.unknown import ScriptError

needs_fissix = pytest.mark.skipif(
    importlib.util.find_spec("fissix") is None,
    reason="the extra `scripts` is not installed",
)

OLD = """\
import math
print(1 / 2, 7 / 2.0, -1 / 2, True / 2)
x = 7
x /= 2
d = {"a": 1}
d["a"] /= 2
print(x, d, range(3) + [1], map(abs, [-1]), zip([1], [2]), filter(None, [0, 1]))
keys = d.keys()
keys.sort()
print(keys, d.has_key("b"), list(d.iteritems()), iter([5]).next())
print(round(2.5), math.ceil(1.2) / 2, xrange(3)[1], unicode("u"), reduce(max, [1, 2]))
print(isinstance("", basestring), cmp(1, 2), len(file(__file__).readline()))
class Empty:
    __metaclass__ = type
    def __nonzero__(self): return False
print(bool(Empty()))
"""
MEANT = [
    "0 3.5 -1 0",
    "3 {'a': 0} [0, 1, 2, 1] [1] [(1, 2)] [1]",
    "['a'] False [('a', 0)] 5",
    "3.0 1.0 1 u 2",
    "True -1 12",
    "False",
]


@needs_fissix
def test_operators_and_builtins_have_their_python_2_meaning(run):
    ran = run(OLD)
    assert ran.problem is None, ran.complained
    assert ran.printed == MEANT
    assert len(ran.said) == 1  # At the first of them.
    assert ran.said[0].startswith("program.py:2: 1 / 2 is 0, as in Python 2;")


def test_a_program_that_names_python3_runs_as_python_3(run):
    text = "#!/usr/bin/env python3\nprint(1 / 2, round(2.5), range(2))\n"
    assert run(text).printed == ["0.5 2 range(0, 2)"]
    text = "from __future__ import division\nprint(1 / 2)\n"
    assert run(text).printed == ["0.5"]


def test_whole_floats_count_in_python_2(run):
    ran = run(
        "import math, numpy.linalg\n"
        "from numpy import linspace\n"
        "n = math.ceil(0.05 / 0.02)\n"
        "print(linspace(0, 1, n), numpy.linspace(0, 1, num=n)[1], range(1, n))\n"
        "print(len(numpy.zeros(n)), numpy.ones((2, n)).shape, numpy.eye(n)[0, 0])\n"
        "print(numpy.arange(n), numpy.float(3), numpy.linalg.norm([3, 4]))\n"
        "numpy.zeros(2.5)\n"
    )
    assert ran.printed == [
        "[0.  0.5 1. ] 0.5 [1, 2]",
        "3 (2, 3) 1.0",
        "[0. 1. 2.] 3.0 5.0",
    ], ran.complained
    assert "TypeError" in ran.problem  # As in the Python 2 of later years.


def test_yaml_load_needs_no_loader(run):
    assert run("import yaml\nprint(yaml.load('[1, 2]'))\n").printed == ["[1, 2]"]


def test_modules_beside_the_program_are_of_its_world(run, tmp_path):
    (tmp_path / "beside_it.py").write_text("import time\nt = time.time()\nh = 1 / 2\n")
    text = "import time, beside_it\nprint(beside_it.t, beside_it.h)\ntime.sleep(1)\n"
    assert run(text, end=0.01).printed == ["0.0 0"]
    # Found anew by the next program.
    assert run(text, end=0.02).printed == ["0.01 0"]


def test_packages_from_elsewhere_keep_their_world(run, tmp_path, monkeypatch):
    for name in ("known", "own"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("")
        (tmp_path / name / "half.py").write_text("half = 1 / 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("known")
    ran = run("import known.half, own.half\nprint(known.half.half, own.half.half)\n")
    assert ran.printed == ["0.5 0"]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("#!/usr/bin/python3\nprint 'a'\n", ":2: "),
        ("x = (\n", ":1: "),
        ("def f():\n  pass\n x\n", ":3: "),
        # Python 3 stops at what is good Python 2.
        pytest.param(
            "x = 1\nprint 'a'\nif x\n  pass\n",
            r":2: .*Python 2: .*\(3, 4\)",
            marks=needs_fissix,
        ),
    ],
)
def test_invalid_python_is_refused_with_its_line(tmp_path, text, where):
    path = tmp_path / "wrong.py"
    path.write_text(text)
    with pytest.raises(ScriptError, match=f"wrong.py{where}"):
        Program(path)


def test_python2_without_fissix_names_the_extra_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fissix.pgen2.parse", None)
    path = tmp_path / "old.py"
    path.write_text("x = 1\nprint 'a'\n")
    with pytest.raises(ScriptError, match=r"old.py:2: .*atlas-drake\[scripts\]"):
        Program(path)
    path.write_text("print('a')\n")
    Program(path)


@needs_fissix
def test_print_without_parentheses_is_read(run):
    ran = run(
        "import sys\n"
        "def f():\n"
        "\tif True:\n"
        "        \treturn `3`\n"  # A tab is eight columns.
        'print "so", f(), 3 <> 4, 0777\n'
        'print >>sys.stdout, "a",\n'
        "try:\n"
        '    raise ValueError, "bad"\n'
        "except ValueError, error:\n"
        "    print error\n"
        "print 1 / 0\n"
    )
    assert ran.printed[:2] == ["so 3 True 511", "a bad"]
    # The line is that of the program as it was written.
    assert "line 11" in ran.complained
    assert "ZeroDivisionError" in ran.problem
