"""The lab's inverse Jacobian as people write it, against the closed forms of the leg."""

import numpy as np
import pytest
from work import calls

from drake_leg.kinematics.leg import LegGeometry, determinant, foot_jacobian
from drake_leg.simulink.matlab.program import program

LEG = LegGeometry(l1=0.05, l2=0.1, l3=0.1, sign=1)

STEP_BY_STEP = """function y = jacob_inv(u)
%#codegen
% lengths in mm
l1 = 50; l2 = 100; l3 = 100;
q1 = u(1); q2 = u(2); q3 = u(3);
dx = u(4); dy = u(5); dz = u(6);
c1 = cos(q1); s1 = sin(q1);
c23 = cos(q2+q3); s23 = sin(q2+q3);
r = l1 + l2*cos(q2) + l3*c23;
h = l2*sin(q2) + l3*s23;
J = [-s1*r -c1*h -c1*l3*s23;
      c1*r -s1*h -s1*l3*s23;
      0 r-l1 l3*c23];
y = (inv(J)*[dx;dy;dz])';
"""

WRITTEN_OUT = """function y = jacob_inv(u)
  q1=u(1);q2=u(2);q3=u(3);
  J=[-sin(q1)*(50+100*cos(q2)+100*cos(q2+q3)), -100*cos(q1)*(sin(q2)+sin(q2+q3)), ...
     -100*cos(q1)*sin(q2+q3)
     cos(q1)*(50+100*cos(q2)+100*cos(q2+q3)),  -100*sin(q1)*(sin(q2)+sin(q2+q3)), ...
     -100*sin(q1)*sin(q2+q3)
     0, 100*cos(q2)+100*cos(q2+q3), 100*cos(q2+q3)];
  y=(inv(J)*u(4:6))';
  y=[y det(J)];
end
"""

PRODUCT_OF_TRANSFORMS = """function [qd, detJ] = f(q1, q2, q3, dx, dy, dz)
% Jacobian from the frames: z x OE
T1 = khalil(0, 0, q1);
T2 = T1*khalil(50, pi/2, q2);
T3 = T2*khalil(100, 0, q3);
foot = T3*[100; 0; 0; 1];
J = zeros(3);
J(:,1) = cross(T1(1:3,3), foot(1:3) - T1(1:3,4));
J(:,2) = cross(T2(1:3,3), foot(1:3) - T2(1:3,4));
J(:,3) = cross(T3(1:3,3), foot(1:3) - T3(1:3,4));
detJ = det(J);
qd = J\\[dx; dy; dz];
end

function T = khalil(d, alpha, theta)
ct = cos(theta); st = sin(theta);
ca = cos(alpha); sa = sin(alpha);
T = [ct,    -st,    0,   d
     st*ca,  ct*ca, -sa, 0
     st*sa,  ct*sa, ca,  0
     0,      0,     0,   1];
end
"""

BY_ELEMENTS = """function [y] = jacob_inv(u)
r = 50 + 100*cos(u(2)) + 100*cos(u(2)+u(3));
for i = 1:3
  for j = 1:3
    if i == 3 && j == 1
      J(i,j) = 0;
    elseif j == 1
      J(i,j) = r*sin(u(1) - i*pi/2 + pi*(i == 1)/1 + pi*(i == 2) + (i == 1)*pi/2);
    else
      h = (j == 2)*100*[sin(u(2)) cos(u(2))] + 100*[sin(u(2)+u(3)) cos(u(2)+u(3))];
      side = [-cos(u(1))*h(1); -sin(u(1))*h(1); h(2)];
      J(i,j) = side(i);
    end
  end
end
J(1,1) = -r*sin(u(1)); J(2,1) = r*cos(u(1));
y = [pinv(J)*u(4:end); det(J)];
"""


def signals(rng, count=200):
    """Postures off the singular families, and velocities in mm/s."""
    q = rng.uniform(-np.pi, np.pi, (6 * count, 3))
    q = q[np.abs(determinant(LEG, q)) > 2e-5][:count]
    assert len(q) == count
    return q, rng.uniform(-70.0, 70.0, (count, 3))


@pytest.mark.slow
@pytest.mark.parametrize("code", [STEP_BY_STEP, WRITTEN_OUT, PRODUCT_OF_TRANSFORMS, BY_ELEMENTS])
def test_the_labs_inverse_jacobian_in_several_hands(code, rng):
    function = program(code)
    for q, v in zip(*signals(rng), strict=True):
        u = [*q, *v]
        results = function.call(*u) if len(function.inputs) == 6 else function.call(u)
        found = np.concatenate(results)
        J = foot_jacobian(LEG, q)
        assert found[:3] == pytest.approx(np.linalg.solve(J, v / 1e3), rel=1e-9, abs=1e-9)
        if len(found) == 4:
            assert found[3] == pytest.approx(1e9 * determinant(LEG, q), rel=1e-9)


def test_at_the_published_start():
    u = [np.pi / 2, np.radians(-50), np.radians(-90), 70, 0, 0]
    *qd, det = program(WRITTEN_OUT).call(u)[0]
    # v is across the leg: the hip alone turns, at 70 mm/s over a reach of 37.7 mm
    assert qd == pytest.approx([-70 / 37.674317, 0, 0], abs=1e-6)
    assert det == pytest.approx(3.767e5, rel=1e-3)


def test_a_stretched_leg_gives_no_finite_rates_and_no_error():
    for q in ([0.0, 0.0, 0.0], [0.0, np.pi / 2, np.pi / 6]):
        rates = program(WRITTEN_OUT).call([*q, 70, 10, 5])[0]
        assert not np.isfinite(rates[:3]).all() or np.abs(rates[:3]).max() > 1e10


def test_it_is_interpreted_with_little_work():
    function, u = program(WRITTEN_OUT), [1.5, -0.8, -1.5, 70.0, 0.0, 0.0]
    assert calls(lambda: function.call(u)) < 1500
