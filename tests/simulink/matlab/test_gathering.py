"""Elements that are gathered, maps, errors that are raised again."""

import numpy as np
import pytest

from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.specials import SPECIAL
from drake_leg.simulink.matlab.workspace import Workspace


def ran(text):
    workspace = Workspace()
    workspace.run(text, name="s.m")
    return workspace


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[a, b] = deal(3, 4); r = [a b];", [3, 4]),
        ("[a, b] = deal(7); r = [a b];", [7, 7]),
        ("r = accumarray([1; 2; 1], [10; 20; 30])';", [40, 20]),
        ("r = accumarray([1 1; 2 3; 1 1], 1, [2 3]); r = r(:)';", [2, 0, 0, 0, 0, 1]),
        ("r = accumarray([1; 3; 1], [4; 5; 9], [], @max, -1)';", [9, -1, 5]),
        ("r = filter(1, [1 -0.5], [1 1 1]);", [1, 1.5, 1.75]),
        ("[y, z] = filter([2 2], 2, [1 2 3]); r = [y z filter([1 1], 1, 4, z)];", [1, 3, 5, 3, 7]),
        ("r = filter([1 1], 1, [1 2; 3 4], [], 2); r = r(:)';", [1, 3, 3, 7]),
        ("r = [sub2ind([3 4], 2, 3) sub2ind([2 3 4], 2, 3, 4)];", [8, 24]),
        ("[i, j] = ind2sub([3 4], [8 12]); r = [i j];", [2, 3, 3, 4]),
        ("[i, j] = ind2sub([2 3 4], 24); r = [i j];", [2, 12]),
        ("r = [mode([1 2 2 3]) mode([3 3 1 1])];", [2, 1]),
    ],
)
def test_elements_are_gathered(text, expected):
    found = ran(text)
    assert not found.skipped
    np.testing.assert_allclose(found.evaluate("r").ravel(), expected, atol=1e-15)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("m = containers.Map({'x','y'}, [10 20]); r = [m('x') m('y')];", [10, 20]),
        ("m = containers.Map([3 1 2], {30, 10, 20}); r = [m(1) m(2) m(3)];", [10, 20, 30]),
        ("m = containers.Map([3 1], [30 10]); r = [m.Count m(1)];", [2, 10]),
        ("m = containers.Map('x', [1 2]); r = m('x');", [1, 2]),
        ("m = containers.Map({'x'}, {[1 2]}); r = m('x');", [1, 2]),
    ],
)
def test_a_map_has_a_value_for_each_key(text, expected):
    found = ran(text)
    assert not found.skipped
    np.testing.assert_array_equal(found.evaluate("r").ravel(), expected)


def test_a_map_without_a_value_for_each_key_is_refused():
    (skipped,) = ran("m = containers.Map({'x','y'}, 5);").skipped
    assert "2 keys and 1 values" in str(skipped)


def test_a_map_is_shared():
    found = ran(
        "m = containers.Map; m('b') = 1; m('a') = [1 2]; other = m; other('z') = 3;\n"
        "s.map = containers.Map({'x','y'}, {5, 'q'}); s.map('w') = 6;\n"
        "n = containers.Map('KeyType', 'double', 'ValueType', 'any'); n(3) = 4;\n"
        "k = strjoin(m.keys(), ''); m.remove('z'); l = strjoin(keys(other), '');\n"
        "r = [m.Count m('a')(2) s.map('x') s.map.Count n(3) isKey(m, 'q') length(n) isempty(m)];\n"
        "v = s.map.values({'y'}); w = v{1}; has = s.map.isKey({'x', 'v'}); is = isa(m, 'handle');"
    )
    assert not found.skipped
    assert found.evaluate("r").tolist() == [[2, 2, 5, 3, 4, 0, 1, 0]]
    assert (found.variables["k"], found.variables["l"], found.variables["w"]) == ("abz", "ab", "q")
    assert found.evaluate("has").tolist() == [[True, False]]


def test_a_key_that_is_not_there_is_told():
    found = ran("m = containers.Map; x = m('foot'); y = m(3); z = m.Sort;")
    reasons = [one.reason for one in found.skipped]
    assert reasons[0] == "the map has no key 'foot'"
    assert reasons[1] == "the keys of this map are texts"
    assert "has no property 'Sort'" in reasons[2]


def test_parameters_of_blocks_take_the_value_of_a_parameter_object():
    found = ran(
        "gain = Simulink.Parameter(3); mass = Simulink.Parameter; mass.Value = [1 2];\n"
        "mass.CoderInfo.StorageClass = 'Auto'; mass.Unit = 'kg'; twice = 2*mass.Value;\n"
        "motor = Simulink.Parameter(struct('R', 4)); wrong = gain.Valeu;"
    )
    assert found.evaluate("[gain*mass motor.R twice]").tolist() == [[3, 6, 4, 2, 4]]
    assert [one.what for one in found.skipped] == ["wrong"]


def test_errors_are_raised_again():
    found = ran(
        "try, error('a:b', 'x %d', 3); catch e, try, rethrow(e); catch f, end, end\n"
        "try, throw(MException('q:r', 'no %s', 'more')); catch g, end\n"
        "try, assert(false, 'k:l', 'of %d', 2); catch h, end\n"
        "try, error(struct('message', 'mine', 'identifier', 'm:n')); catch i_, end"
    )
    said = [(found.variables[name]["identifier"], found.variables[name]["message"])
            for name in ("f", "g", "h", "i_")]  # fmt: skip
    assert said == [("a:b", "x 3"), ("q:r", "no more"), ("k:l", "of 2"), ("m:n", "mine")]


QUATERNIONS = "p = [0.2 -0.4 0.1 0.9]; q = quatnormalize([1 2 3 4; -1 0.5 0.2 0.1]);"


@pytest.mark.parametrize(
    "identity",
    [
        "quatmultiply(q, quatinv(q)) - [1 0 0 0]",
        "quatmod(q) - 1",
        "quatnorm(p) - p*p'",
        "quat2rotm(quatmultiply(q(1,:), q(2,:))) - quat2rotm(q(1,:))*quat2rotm(q(2,:))",
        "quatrotate(q(1,:), [1 2 3])' - quat2rotm(q(1,:))'*[1; 2; 3]",
        "quat2dcm(q(1,:)) - quat2rotm(q(1,:))'",
        "abs(dcm2quat(quat2dcm(q))) - abs(q)",
        "quat2eul(angle2quat(0.1, 0.2, 0.3)) - [0.1 0.2 0.3]",
        "angle2dcm(0.1, 0.2, 0.3, 'XYZ') - eul2rotm([0.1 0.2 0.3], 'XYZ')'",
        "quat2eul(eul2quat([0.1 0.2 0.3; 0.3 0.2 0.1])) - [0.1 0.2 0.3; 0.3 0.2 0.1]",
        "rotm2eul([0 0 1; 0 1 0; -1 0 0], 'ZYZ') + [pi pi/2 pi]",  # as documented
        "tform2eul(eul2tform([0.1 0.2 0.3], 'ZXZ'), 'ZXZ') - [0.1 0.2 0.3] + [pi 0.4 pi].*[0 0 0]",
        "trotx(0.3)*transl(1, 2, 3)*[0; 0; 0; 1] - [rotx(rad2deg(0.3))*[1; 2; 3]; 1]",
        "transl(transl([1 2 3])) - [1; 2; 3]",
        "vex(skew([1 2 3])) - [1; 2; 3]",
        "skew([1 2 3])*[4; 5; 6] - cross([1 2 3], [4 5 6])'",
        "t2r(r2t(rotz(30))) - rotz(30)",
        "trotz(90, 'deg') - r2t(rotz(90))",
    ],
)
def test_rotations_obey_identities(identity):
    found = ran(f"{QUATERNIONS} e = max(max(abs({identity})));")
    assert not found.skipped
    assert found.evaluate("e") < 1e-14


@pytest.mark.parametrize("order", ["ZYX", "XYZ", "ZYZ", "XZX", "YXZ", "ZXY", "XYX", "YZX"])
def test_angles_give_their_matrix_back(order):
    for angles in ([0.4, -0.3, 1.2], [2.5, 1.2, -3.0], [0.3, 0.0, 0.4], [0.3, np.pi / 2, 0.4]):
        matrix = KNOWN["eul2rotm"](None, 1, np.array([angles]), order)
        again = KNOWN["rotm2eul"](None, 1, matrix, order)
        np.testing.assert_allclose(KNOWN["eul2rotm"](None, 1, again, order), matrix, atol=1e-15)


@pytest.mark.parametrize("value", ["0.3", "'abc'", "{1,'a'}", "[]", "@sin", "struct('a',1)"])
def test_no_function_that_calls_others_breaks_on_any_value(value):
    names = set(SPECIAL) - {"Simulink.Mask.getParameter"}
    code = "\n".join(
        f"v = {name}({given});"
        for name in sorted(names)
        for given in (value, f"{value}, {value}, {value}")
    )
    workspace = Workspace()
    for line in code.splitlines():
        workspace.run(line, name="s.m")
    assert all(0 < len(str(one)) < 400 for one in workspace.skipped)


def test_numbers_are_read_from_texts_and_nothing_else():
    found = ran("r = str2num('[1 2; 3 4]'); e = isempty(str2num('')); x = str2num('[1 2]*2');")
    np.testing.assert_array_equal(found.evaluate("r"), [[1, 2], [3, 4]])
    assert found.evaluate("e")
    (skipped,) = found.skipped
    assert "'str2num' reads numbers alone, not '[1 2]*2'" in str(skipped)


def test_a_number_printed_as_text_is_a_letter_if_it_is_whole():
    found = ran("r = sprintf('%s|%c|%s', 72, 105, 0.5);")
    assert str(found.evaluate("r")) == "H|i|5.000000e-01"
