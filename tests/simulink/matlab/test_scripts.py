"""Scripts: values as Octave computes them, what is skipped, and what stops."""

import math
import re
import time
import zlib

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.linking import home_of
from drake_leg.simulink.matlab import matfiles
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.program import program
from drake_leg.simulink.matlab.workspace import Workspace


def ran(text, **folders):
    workspace = Workspace(**folders)
    workspace.run(text, name="s.m")
    return workspace


# Each script, and the r that Octave 8 has after it (of complex numbers, real and imaginary parts).

OCTAVE = [
    ("r = [1 2;3 4](2,1);", "3"),
    ("x = 5; x(4) = 2; r = x;", "[5 0 0 2]"),
    ("x = []; x(:,1) = [1;2;3]; x(:,2) = [4;5;6]; r = x;", "[1 4;2 5;3 6]"),
    ("X(2,:) = [1 2 3]; r = X;", "[0 0 0;1 2 3]"),
    ("x = 1:5; x([1 3]) = []; r = x;", "[2 4 5]"),
    ("A = [8 1 6;3 5 7;4 9 2]; A(:,2) = []; r = A;", "[8 6;3 7;4 2]"),
    ("A = zeros(2,2,3); A(:,:,2) = [1 2;3 4]; r = sum(A, 3);", "[1 2;3 4]"),
    ("A = zeros(2,2,3); A(:,:,2) = [1 2;3 4]; r = size(A);", "[2 2 3]"),
    ("A = reshape(1:24, 2,3,4); r = A(:,:,end);", "[19 21 23;20 22 24]"),
    ("A = reshape(1:24, 2,3,4); r = squeeze(A(1,2,:))';", "[3 9 15 21]"),
    ("A = reshape(1:24, 2,3,4); r = A(2,7);", "14"),
    ("s.a = 1; s.b.c = [1 2 3]; s.b.c(2) = 7; r = s.b.c;", "[1 7 3]"),
    ("s(3).m = 4; s(1).m = 2; s(2).m = 3; r = [s.m];", "[2 3 4]"),
    ("s = struct('a', {1,2,3}); r = numel(s);", "3"),
    ("s.x = 1; f = 'y'; s.(f) = 5; r = s.y + s.('x');", "6"),
    ("c = {1, [2 3], 'abc'}; r = c{2}(2) + numel(c{3});", "6"),
    ("c = {}; c{3} = 4; r = [numel(c) isempty(c{1})];", "[3 1]"),
    ("c = {1,2,3}; c(2) = []; r = [c{:}];", "[1 3]"),
    ("f = @(x, y) x^2 + y; r = f(3, 4);", "13"),
    ("k = 2; f = @(x) k*x; k = 5; r = f(3);", "6"),
    ("r = arrayfun(@(x) x^2, [1 2 3]);", "[1 4 9]"),
    ("r = cellfun(@numel, {'a','bcd',''});", "[1 3 0]"),
    ("q = cellfun(@(x) [x 'z'], {'a','bc'}, 'UniformOutput', false); r = numel(q{2});", "3"),
    ("r = 0; for k = [1 2;3 4], r = r*10 + k(2); end", "34"),
    (
        "r = 0; k = 0; while true, k = k + 1; if k > 5, break; end, "
        "if mod(k,2), continue, end, r = r + k; end",
        "6",
    ),
    ("r = 0; switch 'ab', case {'x','ab'}, r = 1; otherwise, r = 2; end", "1"),
    ("r = 0; switch 3, case {1,2}, r = 1; case 3, r = 7; end", "7"),
    ("try, error('my:id', 'bad %d', 3); catch e, r = double(e.message(1)); end", "98"),
    ("r = (3+4i)*(1-2i);", "[11 -2]"),
    ("r = abs(3+4i) + real(2i*2i);", "1"),
    ("r = [1+2i 3]';", "[1 -2;3 -0]"),
    ("r = sqrt(-4);", "[0 2]"),
    ("r = (-8)^(1/3);", "[1 1.732050807568877]"),
    ("r = exp(1i*pi/2)*1e3;", "[6.1232339957367662e-14 1000]"),
    ("r = 7:-2:0;", "[7 5 3 1]"),
    ("r = numel(0:0.1:1);", "11"),
    ("r = mod(-7,3) + rem(-7,3);", "1"),
    ("r = floor(-2.5) + round(2.5) + fix(-2.7);", "-2"),
    ("r = [1 2;3 4] \\ [5;6];", "[-3.9999999999999987;4.4999999999999991]"),
    ("r = [5 6] / [1 2;3 4];", "[-1 2]"),
    (
        "r = [1 2;3 4]^-1;",
        "[-1.9999999999999996 0.99999999999999978;1.4999999999999998 -0.49999999999999989]",
    ),
    ("r = 2.^[1 2 3];", "[2 4 8]"),
    ("r = any([0 0;0 1]) + all([1 1;0 1]);", "[0 2]"),
    ("r = cumsum([1 2;3 4]);", "[1 2;4 6]"),
    ("r = unwrap([0 3 6-2*pi 9-4*pi]);", "[0 3 6 9]"),
    ("r = cumprod([1 2 3 4]);", "[1 2 6 24]"),
    ("[m, i] = max([3 9 2]); r = [m i];", "[9 2]"),
    ("r = max([1 5;7 2], [], 2);", "[5;7]"),
    ("r = min([4 2 8], 3);", "[3 2 3]"),
    ("[s, i] = sort([3 1 2], 'descend'); r = [s; i];", "[3 2 1;1 3 2]"),
    ("r = unique([3 1 2 3 1]);", "[1 2 3]"),
    ("r = find([0 1 0 1 1]);", "[2 4 5]"),
    ("[i, j] = find([0 1;1 0]); r = [i j];", "[2 1;1 2]"),
    ("r = fliplr([1 2 3]);", "[3 2 1]"),
    ("r = kron([1 2],[1;1]);", "[1 2;1 2]"),
    ("r = trace([1 2;3 4]) + det([1 2;3 4]);", "3"),
    ("r = cross([1 2 3],[4 5 6]);", "[-3 6 -3]"),
    ("r = dot([1 2 3],[4 5 6]);", "32"),
    ("r = norm([3 4]) + norm([1 2;3 4], 'fro');", "10.477225575051662"),
    ("r = polyfit([1 2 3],[2 4 6],1);", "[1.9999999999999996 1.356714946300694e-15]"),
    ("r = polyval([1 2 3], 2);", "11"),
    ("r = roots([1 -3 2]);", "[2;1]"),
    ("r = conv([1 2],[1 3]);", "[1 5 6]"),
    ("r = interp1([1 2 3],[10 20 30], 2.5);", "25"),
    ("r = interp1([1 2 3],[10 20 30], 4, 'linear', 'extrap');", "40"),
    ("r = interp1([1 2 3],[10 20 30], [1 1.4 1.5 3], 'nearest');", "[10 10 20 30]"),
    ("r = interp1([1 2 3],[10 20 30], [1 1.4 2 3]', 'previous');", "[10;10;20;30]"),
    ("r = interp1([1 2 3],[10 20 30], [1 1.4 2 3], 'next');", "[10 20 20 30]"),
    ("r = interp1([1 2 3 4],[1 8 27 64], [2.5 5], 'spline');", "[15.625 125]"),
    ("r = interp1([3 1 2],[1 2;3 4;5 6], [1.5 2.5]);", "[4 5;3 4]"),
    ("r = interp1([10 20 30], 1.5);", "15"),
    ("r = isnan(interp1([1 2],[1 2], [0 1 3]));", "[1 0 1]"),
    ("r = interp1([1 2],[1 2], [0 1 3], 'linear', 7);", "[7 1 7]"),
    ("r = interp1([1 2 3],[1 8 27], [0 2], 'pchip', 7);", "[7 8]"),
    ("r = interp1([1 2 3 4],[1 4 9 16], [1.5 2.5], 'cubic');", "[2.25 6.25]"),
    ("r = interp1([1 2 3 4],[0 0 1 1], 2.25, 'cubic');", "0.203125"),
    ("r = interp1([1 2 3 5],[1 8 27 125], 4, 'cubic');", "64"),
    ("r = isnan(interp1([1 2 3],[1 8 27], [0 4], 'cubic'));", "[1 1]"),
    ("[x, y, z] = cylinder([1 2], 4); r = [x(:,1) y(:,2) z(:,5)];", "[1 1 0;2 2 1]"),
    ("[x, y, z] = sphere(2); r = [x(2,:);y(2,:);z(:,1)'];", "[-1 1 -1;0 0 0;-1 0 1]"),
    ("r = trapz([0 1 2],[0 1 4]);", "3"),
    ("r = linspace(0,1,5);", "[0 0.25 0.5 0.75 1]"),
    ("r = repmat([1 2],2,2);", "[1 2 1 2;1 2 1 2]"),
    ("r = eye(2,3);", "[1 0 0;0 1 0]"),
    ("r = diag([1 2]) + diag([3;4]);", "[4 0;0 6]"),
    ("r = diag([1 2;3 4])';", "[1 4]"),
    ("r = blkdiag([1 2],3);", "[1 2 0;0 0 3]"),
    ("r = mean([1 2;3 4]);", "[2 3]"),
    ("r = std([1 2 3 4]);", "1.2909944487358056"),
    ("r = median([3 1 2]);", "2"),
    ("r = isfield(struct('a',1), 'a');", "1"),
    ("r = strcmp({'a','b'}, 'b');", "[0 1]"),
    ("r = double(sprintf('%d_%s', 3, 'ab'));", "[51 95 97 98]"),
    ("r = double(num2str(3.14159, 4));", "[51 46 49 52 50]"),
    ("r = double(num2str(42));", "[52 50]"),
    ("r = double(strrep('abcabc','b','xx'));", "[97 120 120 99 97 120 120 99]"),
    ("r = double(upper('aB'));", "[65 66]"),
    ("r = numel(strsplit('a b c', ' '));", "3"),
    ("r = str2double('2.5') + str2num('[3]');", "5.5"),
    ("r = double(['ab' 'cd']);", "[97 98 99 100]"),
    ("r = 'a' + 1;", "98"),
    ("r = ischar('a') + iscell({}) + isstruct(struct());", "3"),
    ("r = ~isempty([]) + isnumeric(3) + islogical(true);", "2"),
    ("r = true + true;", "2"),
    ("r = xor(true, false);", "1"),
    ("r = bitand(12, 10);", "8"),
    ("r = int32(2.6);", "3"),
    ("r = nnz([1 0 2]);", "2"),
    ("r = expm([0 1;0 0]);", "[1 1;0 1]"),
    ("r = inv([2 0;0 4]);", "[0.5 -0;0 0.25]"),
    ("r = pinv([1;1]);", "[0.49999999999999978 0.49999999999999989]"),
    ("r = rank([1 2;2 4]);", "1"),
    ("r = eig([2 0;0 3]);", "[2;3]"),
    ("r = svd([3 0;0 4]);", "[4;3]"),
    ("r = 1e3*deg2rad(180);", "3141.5926535897929"),
    ("r = atan2(1,-1);", "2.3561944901923448"),
    ("r = hypot(3,4);", "5"),
    ("r = sign(-3:3);", "[-1 -1 -1 0 1 1 1]"),
    ("r = circshift([1 2 3 4], 1);", "[4 1 2 3]"),
    ("r = permute(reshape(1:6,1,2,3), [3 2 1]);", "[1 2;3 4;5 6]"),
    ("r = horzcat([1 2],3) ; r = vertcat(r, r);", "[1 2 3;1 2 3]"),
    ("r = cat(3,[1 2],[3 4]); r = r(:,:,2);", "[3 4]"),
    ("x = 3; x(2,2) = 1; r = x;", "[3 0;0 1]"),
    ("x = 'abc'; r = double(x(end:-1:1));", "[99 98 97]"),
    ("x.y(3).z = 2; r = [numel(x.y) isempty(x.y(1).z)];", "[3 1]"),
    ("a.b = {1,{2,3}}; r = a.b{2}{1};", "2"),
    ("A = [1 2\n3 4]; r = A;", "[1 2;3 4]"),
    ("r = [1 -2] + [1 - 2];", "[0 -3]"),
    ("r = [1, 2, ... comment\n3];", "[1 2 3]"),
    ("r = {1,'a';2,'b'}; r = size(r);", "[2 2]"),
    ("r = isequal([1 2],[1 2]) + isequal('a','b');", "1"),
    ("r = logical([2 0 1]);", "[1 0 1]"),
    ("r = nchoosek(5,2) + factorial(4);", "34"),
    ("r = meshgrid(1:2,1:3);", "[1 2;1 2;1 2]"),
    ("r = vecnorm([3 4;6 8],2,2);", "[5;10]"),
    ("r = setdiff([1 2 3 4],[2 3]);", "[1 4]"),
    ("r = ismember(2,[1 2 3]);", "1"),
    ("x = 1:3; x(end+1) = 9; r = x(end);", "9"),
    (
        "x = zeros(1,3); for k = 1:3, x(k) = k; y = x; x(k) = -k; end, r = [x y];",
        "[-1 -2 -3 -1 -2 3]",
    ),
    ("r = triu([1 2;3 4]) + tril([1 2;3 4]);", "[2 2;3 8]"),
    ("r = isrow([1 2 3]) + iscolumn([1;2]) + isvector(4) + isscalar(4);", "4"),
    ("r = sum(sum([1 2;3 4] > 2 & [1 0;1 1]));", "2"),
    ("r = bitor(5, 2) + power(2,3) + times(2,5) + minus(3,1);", "27"),
    ("r = [1+2i 3].';", "[1 2;3 0]"),
    ("x = 10; r = x.^2 + x';", "110"),
    ("r = unique([2 1; 1 3; 2 1], 'rows');", "[1 3;2 1]"),
    ("[~, i, j] = unique([2 1; 1 3; 2 2], 'rows'); r = [i j];", "[2 2;1 1;3 3]"),
    ("r = unwrap([0 3 -3 0]) - [0 3 2*pi-3 2*pi];", "[0 0 0 0]"),
    ("r = cumtrapz([0 1 3], [0 2 4]);", "[0 1 7]"),
    ("r = sort([3 1+2i -2 0.5i]).';", "[0 0.5;-2 0;1 2;3 0]"),
    ("r = isnan(sort([1 nan 3], 'descend'));", "[1 0 0]"),
    ("[m, k] = max([1+2i 3 -2i]); [~, l] = min([1+2i 3 -2i]); r = [m k l];", "[3 2 3]"),
    # closed forms: x = 1/2 of -x - x + 1 = 0; of the double integrator K = [1 sqrt(3)]
    ("r = lyap(-1, 1);", "0.5"),
    ("r = lqr([0 1; 0 0], [0; 1], eye(2), 1);", "[1 sqrt(3)]"),
]


@pytest.mark.parametrize(("script", "expected"), OCTAVE)
def test_values_are_those_of_octave(script, expected):
    found = np.atleast_2d(ran(script).variables["r"])
    if np.iscomplexobj(found):
        found = np.hstack([found.real, found.imag])
    wanted = np.atleast_2d(Workspace().evaluate(expected))
    assert found.shape == wanted.shape
    np.testing.assert_allclose(found.astype(float), wanted, rtol=1e-13, atol=1e-13)


def test_functions_of_the_script_take_and_give_several_values():
    code = """
    [a, b] = both(2); n = count(1, 2, 3); [~, c] = both(5); k = opt(1); h = opt(1, 9);
    function [p, q] = both(x)
      p = x; q = 2*x;
    end
    function n = count(varargin)
      n = nargin + numel(varargin);
    end
    function y = opt(x, z)
      if nargin < 2, z = 4; end
      y = x + z;
    end
    """
    found = ran(code).variables
    assert [found[name] for name in "abnckh"] == [2, 4, 6, 10, 5, 10]


def test_a_function_of_a_script_keeps_its_persistent_variables():
    found = ran(
        "a = next(); b = next(); function y = next(), persistent k, "
        "if isempty(k), k = 0; end, k = k + 1; y = k; end"
    )
    assert (found.variables["a"], found.variables["b"]) == (1, 2)


def test_an_array_that_is_written_does_not_change_its_copies():
    found = ran(
        "x = zeros(1, 3); x(1) = 1; y = x; x(2) = 7; s.a = x; x(3) = 8; g = @() x; x(1) = 0;"
    )
    assert found.variables["y"].tolist() == [[1, 0, 0]]
    assert found.variables["s"]["a"].tolist() == [[1, 7, 0]]
    assert found.evaluate("g()").tolist() == [[1, 7, 8]]
    assert found.variables["x"].tolist() == [[0, 7, 8]]


def test_a_text_that_is_run_sets_variables_and_has_a_line():
    found = ran(
        "names = {'mass', 'width'};\n"
        "for k = 1:2\n  eval(['leg.' names{k} ' = ' num2str(k + 0.5) ';']);\nend\n"
        "area = eval('leg.width^2');\n"
        "eval('fails(', 'mended = 1;');\n"
        "eval('refused = 1; error(''no'')', 'mended = mended + 1;');\n"
        "evalin('base', 'sum = leg.mass + leg.width;');"
    )
    assert found.evaluate("[leg.mass leg.width area mended sum]").tolist() == [
        [1.5, 2.5, 6.25, 2, 4]
    ]
    assert not found.skipped
    assert found.source["leg"] == "s.m, line 3"


def test_options_may_be_given_by_an_equals_sign():
    found = ran(
        "y = g(1, way='fast', k=3);\nz = g(2);\n"
        "function y = g(a, o)\narguments\n  a\n  o.way = 'slow'\n  o.k = 1\nend\n"
        "y = [a o.k strcmp(o.way, 'fast')];\nend"
    )
    assert found.evaluate("[y; z]").tolist() == [[1, 3, 1], [2, 1, 0]]


def test_a_field_that_is_left_out_is_lost_alone():
    found = ran(
        "leg.mass = 2; leg.foot.size = 1;\nleg.foot.shape = unknown_shape(3);\n"
        "leg.foot.color = 3;\nif unknown_choice, leg.mass = 5; end\narm.mass = unknown_mass;"
    )
    assert found.variables["leg"] == {"foot": {"size": 1.0, "color": 3.0}}
    assert [one.what for one in found.skipped] == ["leg.foot.shape", "leg.mass", "arm.mass"]
    with pytest.raises(
        UnknownValueError, match=r"no field 'shape' \(line 2 of s[.]m: 'unknown_sha"
    ):
        found.evaluate("leg.foot.shape")
    with pytest.raises(UnknownValueError, match=r"'arm' is not a known .* \(line 5 of s[.]m"):
        found.evaluate("arm.mass")


def test_no_toolbox_and_no_project_is_there():
    found = ran(
        "start = 1;\nif ~isempty(ver('parallel'))\n  start = isempty(getCurrentTask());\nend\n"
        "project = currentProject;\ncd(project.RootFolder)\nlicensed = license('test', 'x');"
    )
    assert found.evaluate("[start licensed ispc]").tolist() == [[1, 0, 0]]
    assert not found.skipped


def test_a_text_in_a_function_sets_its_own_variables():
    found = ran("y = f(2);\nfunction y = f(x)\neval('y = 3*x;');\nend")
    assert found.variables["y"] == 6
    assert "x" not in found.variables


def test_a_text_that_runs_itself_ends():
    with pytest.raises(InvalidValueError, match="the calls of eval are nested too deeply"):
        ran("s = 'eval(s)';\neval(s)")


def test_a_block_runs_no_text():
    with pytest.raises(InvalidValueError, match="a text is not run as code in a block"):
        program("function y = f(u)\ny = u;\neval('y = 2;');").call(1.0)
    with pytest.raises(InvalidValueError, match="a text is not run as code in a block"):
        compiled("function y = f(u)\ny = u;\neval('y = 2;');").call({}, np.array(1.0))


# --- what is not run ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("statement", "what"),
    [
        ("system('rm -rf /')", "system"),
        ("!rm -rf /", "!"),
        ("dos dir", "dos"),
        ("plot(1:3)", "plot"),
        ("sim('model')", "sim"),
        ("x = input('mass? ')", "x"),
        ("save all.mat", "save"),
        ("delete('a.m')", "delete"),
        ("evalc('y = 3')", "evalc"),
        ("eval('x = unknown_thing(3)')", "x"),
        ("eval('x = ')", "a statement"),
        ("y = eval('unknown_thing')", "y"),
        ("load nothing.mat", "a statement"),
        ("x = fopen('a.txt')", "x"),
        ("x = unknown_thing(3)", "x"),
        ("open_system('m')", "open_system"),
        ("syms a b", "syms"),
        ("x = randn(3)", "x"),
        ("x = [1 2]*[3 4]", "x"),
    ],
)
def test_what_is_not_run_is_named_and_the_rest_goes_on(statement, what):
    found = ran(f"m1 = 1;\n{statement}\nm2 = 2;")
    assert (found.variables["m1"], found.variables["m2"]) == (1, 2)
    assert "x" not in found.variables
    assert "y" not in found.variables
    (skipped,) = found.skipped
    assert (skipped.what, skipped.file, skipped.line) == (what, "s.m", 2)


def test_what_lacks_because_of_it_is_known():
    found = ran("a = get_param(gcb, 'Gain');\nb = 2*a;\nc = 3;")
    with pytest.raises(UnknownValueError, match="'b' is not a known function") as refusal:
        found.evaluate("b + c")
    assert refusal.value.names == ("b",)
    assert "line 1 of s.m" in found.lacking["a"]
    assert "line 2 of s.m" in found.lacking["b"]


def test_all_unknown_names_of_an_expression_are_told_at_once():
    with pytest.raises(UnknownValueError) as refusal:
        Workspace().evaluate("m1*(m2 + sin(m3)) - pi")
    assert refusal.value.names == ("m1", "m2", "m3")


def test_an_error_of_the_script_stops_it():
    found = ran("a = 1;\nerror('too %s', 'far')\nb = 2;")
    assert found.variables == {"a": 1.0}
    assert "it stops with the error 'too far'" in str(found.skipped[0])


def test_each_variable_names_its_source():
    found = ran("a = 1;\n\nb = 2;")
    found.set("c", 3.0, "--set")
    assert found.source == {"a": "s.m, line 1", "b": "s.m, line 3", "c": "--set"}


def test_a_fixed_variable_is_not_changed_by_scripts():
    workspace = Workspace()
    workspace.set("m", 5.0, "--set", fixed=True)
    workspace.run("m = 1; n = 2*m;", name="s.m")
    assert workspace.variables["m"] == 5
    workspace.run("k = m; clear", name="t.m")
    assert workspace.variables == {"m": 5.0}


# --- files ----------------------------------------------------------------------------------------


def test_functions_and_scripts_are_found_beside_and_in_folders(tmp_path):
    (tmp_path / "lib" / "deep" / "+pkg").mkdir(parents=True)
    (tmp_path / "lib" / "private").mkdir()
    (tmp_path / "lib" / "deep" / "twice.m").write_text("function y = twice(x)\ny = 2*x;")
    (tmp_path / "lib" / "deep" / "+pkg" / "half.m").write_text("function y = half(x)\ny = x/2;")
    (tmp_path / "lib" / "outer.m").write_text("function y = outer(x)\ny = inner(x) + 1;")
    (tmp_path / "lib" / "private" / "inner.m").write_text("function y = inner(x)\ny = 10*x;")
    (tmp_path / "lib" / "deep" / "lengths.m").write_text("L1 = twice(0.1);")
    (tmp_path / "lib" / "deep" / "sin.m").write_text("function y = sin(x)\ny = 99;")
    found = ran(
        "lengths; a = pkg.half(L1); b = outer(2); c = sin(0); run('deep/lengths.m');",
        paths=[tmp_path / "lib"],
    )
    values = [found.variables[name] for name in ("L1", "a", "b")]
    assert values == pytest.approx([0.2, 0.1, 21])
    assert found.variables["c"] == 0  # the folder is not surely on MATLAB's path
    assert found.source["L1"] == "lengths.m, line 1"
    assert not found.skipped


def test_of_files_of_one_name_the_nearest_is_taken(tmp_path):
    for release, length in (("a", 1), ("b", 2)):
        scripts = tmp_path / "lib" / release / "scripts"
        scripts.mkdir(parents=True)
        (scripts / "lengths.m").write_text(f"L = scale*{length};")
        (scripts / "first.m").write_text("lengths;")
        (tmp_path / "lib" / release / f"all_{release}.m").write_text("scale = 10;\nlengths;")
        (tmp_path / "lib" / release / "robot.slx").write_text(f"model {release}")
    (tmp_path / "mine").mkdir()
    copy = tmp_path / "mine" / "my robot.slx"
    copy.write_text("model b")
    folders = {"near": [copy.parent], "paths": [tmp_path / "lib"]}
    for text, model, length in (
        ("scale = 1; lengths;", None, 1),  # else that above
        ("scale = 1; lengths;", copy, 2),
        ("all_a;", copy, 10),  # from the script that uses it
        ("all_b;", None, 20),
    ):
        home = home_of(model, folders["paths"]) if model else None
        assert ran(text, **folders, model=home).variables["L"] == length


def test_nothing_outside_of_the_folders_is_read(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "secret.m").write_text("key = 1;")
    (tmp_path / "in" / "link.m").symlink_to(tmp_path / "secret.m")
    for folders in ({"paths": [tmp_path / "in"]}, {"near": [tmp_path / "in"]}):
        found = ran("run('../secret.m'); addpath('..'); secret; link;", **folders)
        assert "key" not in found.variables


def test_mat_files_of_three_versions_are_read(tmp_path):
    from scipy.io import savemat

    content = {"m": 3.0, "v": np.arange(3.0), "s": {"a": 1.0, "t": "text"}, "c": [[1, 2]]}
    for version, zipped in (("5", False), ("5", True), ("4", False)):
        plain = {k: v for k, v in content.items() if version == "5" or k in "mv"}
        savemat(tmp_path / "d.mat", plain, format=version, do_compression=zipped)
        found = ran("load('d.mat'); n = 2*m; q = load('d', 'm');", near=[tmp_path])
        assert found.variables["n"] == 6
        assert found.variables["q"] == {"m": 3.0}
        if version == "5":
            assert found.evaluate("s.a + numel(s.t)") == 5
    assert found.variables["v"].shape == (1, 3)


def test_a_mat_file_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(matfiles, "MAT_BYTES", 1_000_000)
    bomb = zlib.compress(bytes(2_000_000))
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    (tmp_path / "b.mat").write_bytes(head + np.array([15, len(bomb)], "<u4").tobytes() + bomb)
    found = ran("load b.mat", near=[tmp_path])
    assert "unpacks to more than" in str(found.skipped[0])


# --- budgets --------------------------------------------------------------------------------------


def refusal_of(workspace, text):
    try:
        workspace.run(text, name="s.m")
    except InvalidValueError as refusal:
        return str(refusal)
    return ""


@pytest.mark.parametrize(
    "endless",
    [
        "while 1, end",
        "while 1, x = 1; end",
        "x = 'a'; while 1, x = [x x]; end",
        "x = 1; while 1, x = [x; x]; end",
        "c = {1}; while 1, c = [c c]; end",
        "x = ones(1000); while 1, y = x*x; end",
        "x = ones(1, 1e6); while 1, sum(x); end",
        "x = zeros(1e5);",
        "x = 1:1e9;",
        "x = kron(ones(2000), ones(2000));",
        "x = diag(1:2e5);",
        "x = conv(ones(1, 1e6), ones(1, 1e6));",
        "x = repmat('a', 1e5, 1e5);",
        "s = strrep(blanks(1e4), ' ', blanks(1e4));",
        "for k = 1:1e7, end",
        "f = @(g) g(g); f(f)",
        "y = f(1); function y = f(x), y = f(x); end",
        "x = cell(1e9, 1);",
        "x(1e9) = 1;",
        "s(1e9).a = 1;",
        "x = sprintf('%999d', 1:1e6);",
        "x = linspace(0, 1, 1e9);",
        "x = inv(ones(1400)); y = eig(ones(1400)); z = expm(ones(1400));",
    ],
)
def test_a_script_that_takes_too_much_stops_with_its_line(endless):
    workspace = Workspace(budget=Allowance(steps=100_000))
    began = time.process_time()
    said = refusal_of(workspace, f"a = 1;\n{endless}\n")
    assert re.match("line 2 of s.m: ", said) or workspace.skipped  # or no text is so long
    assert time.process_time() - began < 10
    assert workspace.variables["a"] == 1


def test_a_script_that_runs_itself_stops(tmp_path):
    (tmp_path / "again.m").write_text("again")
    with pytest.raises(InvalidValueError, match="runs itself"):
        ran("again", near=[tmp_path])


def test_one_script_leaves_steps_for_the_next():
    workspace = Workspace(budget=Allowance(steps=50_000))
    with pytest.raises(InvalidValueError, match="takes more than"):
        workspace.run("while 1, end", name="s.m")
    workspace.run("m = 3;", name="t.m")
    assert workspace.variables["m"] == 3


GOOD = """m = [1 2;3 4]; s.a(3).b = 5; c = {1,'two',@(x) x+1}; y = c{3}(4);
for k=1:3, z(k)=k^2; end, z(2)=[]; [mx, im] = max(z); w = 1:3; w(end+1) = 7;
switch 'abc', case {'x','abc'}, q=1; otherwise, q=2; end
try, error('bad'); catch e, msg = e.message; end
i2 = 2i*2i; [~, b] = size(m); t = s.('a')(3).b; A = zeros(2,2,3); A(:,:,2) = m; l = w(w>2);
smi.Solid(2).mass = 3; tot = sum([smi.Solid.mass]); B = inv(m)*m; g=@sin; gg=g(1);
if all(z), n = numel(s.a); elseif any(z), n = -1; else n = sprintf('%d_%s', 3, 'ab'); end
while n > 0, n = n - 1; end, u = cellfun(@numel, {'a','bc'}); v = struct('p', {{1,2}});
"""


def test_the_good_script_is_good():
    found = ran(GOOD)
    assert not found.skipped
    assert math.isclose(found.variables["gg"], math.sin(1))


@pytest.mark.slow
def test_thousands_of_faulty_scripts_neither_crash_nor_hang(rng):
    """Every one ends, and only with the error that names a line."""
    signs = [*"()[]{},;:=~.'\"@\n+-*/^&|<> 0123e", "end", "1e9", "(:)", "{:}", " i ", *KNOWN]
    began = time.process_time()
    for _ in range(2000):
        text = GOOD
        for _ in range(rng.integers(1, 5)):
            at, gone = rng.integers(0, len(text)), rng.integers(0, 8)
            text = text[:at] + str(rng.choice(signs)) + text[at + gone :]
        workspace = Workspace(budget=Allowance(steps=3_000, elements=300_000, largest=100_000))
        said = refusal_of(workspace, text)
        assert not said or re.search(r"line \d+ of s.m", said)
        assert len(said) < 1000
    assert time.process_time() - began < 120


@pytest.mark.parametrize(
    ("call", "message", "identifier"),
    [
        ("error('my:id', 'value %d of %s', 3, 'x')", "value 3 of x", "my:id"),
        ("error('my:id', '100%%')", "100%", "my:id"),
        ("error('100% of it: no')", "100% of it: no", ""),
        ("error('only:this')", "only:this", ""),
        ("error('%d things', 2)", "2 things", ""),
    ],
)
def test_an_error_that_is_caught_tells_what_it_said(call, message, identifier):
    workspace = Workspace()
    workspace.run(f"try, {call}; catch e, m = e.message; k = e.identifier; end", name="s.m")
    assert (workspace.variables["m"], workspace.variables["k"]) == (message, identifier)


@pytest.mark.parametrize("line", ["print -dpng picture", "mex -setup C", "print -dpng"])
def test_a_word_with_an_option_is_a_command(line):
    workspace = Workspace()
    workspace.run(f"a = 1;\n{line}\nb = a -1;", name="s.m")
    assert workspace.variables["b"] == 0.0


def test_an_object_of_a_class_of_properties_is_a_structure_of_them(tmp_path):
    (tmp_path / "Leg.m").write_text("""\
classdef Leg
    % a leg, and its joints
    properties (Access = public)
        knee = Joint
        x       {mustBeNumeric}  % [mm]
        length (1,1) double = 2 * 3; % [mm]
    end
    properties
        name
    end
end
""")
    (tmp_path / "Joint.m").write_text("classdef Joint\n properties\n  limit = [1 2]\n end\nend\n")
    script = "a = Leg; b = a; b.knee.limit(2) = 7; b.x = 2 * b.length;"
    found = ran(script, near=[tmp_path]).variables
    assert found["a"]["knee"]["limit"].tolist() == [[1.0, 2.0]]
    assert found["b"]["knee"]["limit"].tolist() == [[1.0, 7.0]]
    assert found["b"]["x"] == 12.0
    assert list(found["a"]) == ["knee", "x", "length", "name"]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("classdef C < handle\n properties\n  x\n end\nend", "that inherits"),
        ("classdef C\n methods\n  function f(o), end\n end\nend", "with methods is not supported"),
    ],
)
def test_other_classes_are_refused_where_they_are_used(text, why, tmp_path):
    (tmp_path / "C.m").write_text(text)
    with pytest.raises(UnknownValueError, match=why):
        Workspace(near=[tmp_path]).evaluate("C().x + 1")
    assert Workspace(near=[tmp_path]).missing(["C"], {}) == []
