"""Two models that mean the same agree; each true difference is named, and it alone."""

import pytest
from chart_drawings import heated
from model_changes import add_leg, drawn_first_last, rewired
from slx_models import BRICK, JACOB_INV, REVOLUTE, RIGID_TRANSFORM, TO_PHYSICAL, published_leg

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.compare.models import compare_models
from drake_leg.simulink.reader import read_model

FORCE = "sm_lib/Forces and Torques/External Force and Torque"


@pytest.fixture
def compared(tmp_path):
    def of(first, second, **options):
        models = [
            read_model(builder.write(tmp_path / f"{place}.slx"))
            for place, builder in enumerate((first, second))
        ]
        return compare_models(*models, "B.slx", **options)

    return of


def changed(found):
    return sorted((item["name"], item["parameter"]) for item in found.different)


def names(items):
    return [item["name"] for item in items]


def renamed(model):
    """Call everything otherwise, and draw it in the opposite order."""
    for place, block in enumerate(model.blocks.values()):
        block.name = f"X{place}"
    return drawn_first_last(model)


def two_muxes(model):
    mux, parts = model.sid("Mux"), []
    for name, places in (("Mux q", (1, 2, 3)), ("Mux v", (4, 5, 6))):
        part = model.add_block("Mux", name, {"Inputs": "3"}, ports={"in": 3, "out": 1})
        for place, old in enumerate(places, 1):
            rewired(model, f"{mux}#in:{old}", f"{part}#in:{place}")
        parts.append(part)
    for place, part in enumerate(parts, 1):
        model.connect(part, f"{mux}#in:{place}")
    return model.set("Mux", Inputs="2")


def degrees(model):
    for place in (1, 2, 3):
        gain = model.add_block("Gain", f"deg{place}", {"Gain": "180/pi"}, ports={"in": 1, "out": 1})
        name = f"Simulink-PS\nConverter{place}"
        rewired(model, f"{model.sid(name)}#in:1", f"{gain}#in:1")
        model.connect(gain, model.sid(name))
        model.set(name, Unit="deg")
    return model


def initial_in_the_integrators(model):
    for place, angle in enumerate(("90/180*pi", "-50/180*pi", "-90/180*pi"), 1):
        converter = model.sid(f"Simulink-PS\nConverter{place}")
        model.remove(f"Sum{place}").remove(f"q{place} initial")
        model.connect(model.sid(f"Integrator{place}"), converter)
        model.set(f"Integrator{place}", InitialCondition=angle)
    return model


def two_transforms(model):
    far = model.sid("Rigid Transform1")
    turn = model.add_library(
        RIGID_TRANSFORM,
        "Turn",
        {"RotationMethod": "StandardAxis", "RotationStandardAxis": "+X", "RotationAngle": "90"},
        ports={"lconn": 1, "rconn": 1},
    )
    model.set("Rigid Transform1", RotationMethod=None)
    rewired(model, f"{far}#rconn:1", f"{turn}#rconn:1")
    model.physical(f"{far}#rconn:1", f"{turn}#lconn:1")
    return model


def in_a_subsystem(model):
    """Put the integrator of the ankle into a subsystem."""
    inner = model.sid("Integrator3")
    system = model.add_block("SubSystem", "Sub", ports={"in": 1, "out": 1})
    rewired(model, f"{inner}#in:1", f"{system}#in:1")
    rewired(model, f"{inner}#out:1", f"{system}#out:1")
    ends = [
        model.add_block(kind, kind, {"Port": "1"}, system=system) for kind in ("Inport", "Outport")
    ]
    model.blocks[inner].system = system
    model.connect(f"{ends[0]}#out:1", f"{inner}#in:1")
    model.connect(f"{inner}#out:1", f"{ends[1]}#in:1")
    for line in model.lines[-2:]:
        line.system = system
    return model


OTHERWISE = [
    renamed,
    two_muxes,
    degrees,
    initial_in_the_integrators,
    two_transforms,
    in_a_subsystem,
]


@pytest.mark.parametrize("drawn", OTHERWISE, ids=lambda drawn: drawn.__name__)
def test_a_model_drawn_otherwise_agrees_both_ways(compared, drawn):
    for models in (
        (published_leg(), drawn(published_leg())),
        (
            drawn(published_leg()),
            published_leg(),
        ),
    ):
        found = compared(*models)
        assert found.agrees, (found.different, found.missing)
        assert not found.extra
        blocks = [item for item in found.matched if item["what"] == "block"]
        assert len(blocks) == len(models[0].blocks)


@pytest.mark.parametrize(
    ("block", "changes", "expected"),
    [
        ("Rigid Transform2", {"TranslationCartesianOffset": "[.06 0 0]"}, None),
        ("Rigid Transform1", {"RotationAngle": "-90"}, "rotation"),
        ("Brick Solid1", {"Density": "7850"}, None),
        ("Revolute Joint1", {"DampingCoefficient": "0.1"}, None),
        ("Mechanism\nConfiguration", {"GravityVector": "[0 0 -9.81]"}, None),
        ("Sine Wave", {"Amplitude": "50"}, None),
        ("Sine Wave", {"Frequency": "2"}, None),
        ("Constant y", {"Value": "5"}, None),
        ("q2 initial", {"Value": "-1"}, None),
        ("Integrator1", {"LimitOutput": "on"}, None),
        ("Simulink-PS\nConverter1", {"SimscapeFilterOrder": "1"}, None),
        ("6-DOF Joint", {"PxSpringStiffness": "3"}, None),
    ],
    ids=lambda value: value if isinstance(value, str) else None,
)
def test_one_changed_number_is_one_difference(compared, block, changes, expected):
    found = compared(published_leg().set(block, **changes), renamed(published_leg()))
    assert changed(found) == [(block.replace("\n", " "), expected or next(iter(changes)))]
    assert not found.missing
    assert not found.extra


def test_both_values_are_told_as_they_are_typed(compared):
    (one,) = compared(published_leg(), published_leg(amplitude="50")).different
    assert (one["first"], one["second"]) == (70.0, 50.0)


def test_a_gain_more_is_one_difference(compared):
    model = published_leg()
    gain = model.add_block("Gain", "Slow", {"Gain": "0.5"}, ports={"in": 1, "out": 1})
    rewired(model, f"{model.sid('Integrator3')}#in:1", f"{gain}#in:1")
    model.connect(gain, model.sid("Integrator3"))
    (one,) = compared(model, published_leg()).different
    assert (one["name"], one["first"], one["second"]) == ("Integrator3", 0.5, 1.0)


def test_code_that_does_the_same_agrees_and_another_law_tells_two_numbers(compared):
    backslash = published_leg(script=JACOB_INV.replace("inv(J)*[dx;dy;dz]", "J\\[dx;dy;dz]"))
    assert compared(published_leg(), backslash).agrees
    slip = published_leg(
        script=JACOB_INV.replace("cos(q1)*r, -sin(q1)*h,", "cos(q1)*r, sin(q1)*h,")
    )
    (one,) = compared(published_leg(), slip).different
    assert one["name"] == "MATLAB Function"
    assert one["why"].startswith("its code is another law: output 1 is ")


def test_code_that_cannot_be_read_is_the_same_only_as_text(compared):
    odd = JACOB_INV.replace("inv(J)", "reciprocal(J)")
    assert compared(published_leg(script=odd), published_leg(script=f"% a comment\n{odd}")).agrees
    (one,) = compared(published_leg(script=odd), published_leg()).different
    assert "could not be" in one["why"] or "cannot be" in one["why"]


def test_another_unit_of_length_is_one_difference(compared):
    model = published_leg()
    for block in model.blocks.values():
        for key in ("TranslationCartesianOffset", "BrickDimensions", "SphereRadius"):
            if key in block.parameters:
                block.parameters[key] = f"1000*{block.parameters[key]}"
    (one,) = compared(model, published_leg()).different
    assert (one["what"], one["first"]) == ("scale", 1000.0)


def legs(order, *, length=0.1, wrong=None):
    """Draw the leg of the reports with passive ones beside it, in an order."""
    model = published_leg()
    for leg in order:
        mount = f"[{0.1 * leg:g} {0.2 * (leg % 2):g} 0]"
        add_leg(model, f"leg {leg}", mount, 0.12 if leg == wrong else length)
    return model


@pytest.mark.slow
def test_six_legs_in_any_order_and_by_any_names(compared):
    found = compared(legs((1, 2, 3, 4, 5)), renamed(legs((4, 2, 5, 1, 3))))
    assert found.agrees, (found.different, found.missing)
    wrong = compared(legs((1, 2, 3, 4, 5), wrong=3), renamed(legs((4, 2, 5, 1, 3))))
    assert changed(wrong) == [
        (f"leg 3 to {place}", "TranslationCartesianOffset") for place in (1, 2)
    ]


def test_branches_of_which_one_is_like_a_part_of_another_are_matched_with_themselves(compared):
    """A leg beside a longer one that ends in the same joints and bricks."""
    model = add_leg(add_leg(published_leg(), "short", "[0 1 0]"), "long", "[0 2 0]")
    tip = model.add_library(REVOLUTE, "tip", ports={"lconn": 1, "rconn": 1})
    brick = model.add_library(BRICK, "end", ports={"rconn": 1})
    model.physical(f"{model.sid('long joint 2')}#rconn:1", f"{tip}#lconn:1")
    model.physical(f"{tip}#rconn:1", f"{brick}#rconn:1")
    found = compared(model, model)
    assert found.agrees, (found.different, found.missing)
    assert not found.extra


def test_a_leg_more_is_missing_and_a_leg_less_is_extra(compared):
    many, few = legs((1, 2, 3)), legs((3, 1))
    found = compared(many, few)
    assert {name[:5] for name in names(found.missing)} == {"leg 2"}
    assert not found.different
    found = compared(legs((3, 1)), legs((1, 2, 3)))
    assert found.agrees
    assert names(found.extra) == [f"leg 2 joint {place}" for place in range(3)]


def test_a_block_more_is_missing_with_the_wire_after_it(compared):
    model = published_leg()
    limit = model.add_block("Saturate", "Limit", ports={"in": 1, "out": 1})
    rewired(model, f"{model.sid('Integrator3')}#in:1", f"{limit}#in:1")
    model.connect(limit, model.sid("Integrator3"))
    found = compared(model, published_leg())
    assert [i["name"] for i in found.missing if i["what"] == "block"] == ["Limit"]
    assert changed(found) == [("Integrator3", "in:1")]
    found = compared(published_leg(), model)
    assert names(found.extra) == ["Limit"]
    assert changed(found) == [("Integrator3", "in:1")]


def test_two_drives_exchanged(compared):
    model = published_leg()
    drives = [model.sid(f"Simulink-PS\nConverter{place}") for place in (1, 2)]
    ends = [f"{drive}#rconn:1" for drive in drives]
    rewired(model, ends[0], "x")
    rewired(model, ends[1], ends[0])
    rewired(model, "x", ends[1])
    found = compared(model, published_leg())
    assert not found.agrees
    assert all("in:" in p or "connected" in p for _, p in changed(found))


def pushed(place="Rigid Transform3", value="1"):
    """Let a force push the leg where a transform leads."""
    model = published_leg()
    force = model.add_library(FORCE, "Push", ports={"lconn": 2, "rconn": 1})
    source = model.add_block("Constant", "Newtons", {"Value": value})
    converter = model.add_library(TO_PHYSICAL, "to N", {"Unit": "N"}, ports={"in": 1, "rconn": 1})
    model.connect(source, converter)
    model.physical(f"{converter}#rconn:1", f"{force}#lconn:1")
    model.physical(f"{force}#rconn:1", f"{model.sid(place)}#rconn:1")
    return model


@pytest.mark.slow
def test_a_force_at_another_place(compared):
    assert compared(pushed(), renamed(pushed())).agrees
    (one,) = compared(pushed("Rigid Transform2"), pushed()).different
    assert one["name"] == "Push"
    assert one["parameter"].startswith("place of rconn:1 on the link of joint")
    (one,) = compared(pushed("Rigid Transform1"), pushed()).different
    assert one["parameter"] == "what rconn:1 is connected with"
    assert changed(compared(pushed(value="2"), pushed())) == [("Newtons", "Value")]


def test_a_joint_of_another_kind(compared):
    model = published_leg()
    model.blocks[model.sid("Revolute Joint2")].source = REVOLUTE.replace("Revolute", "Prismatic")
    found = changed(compared(model, published_leg()))
    assert [parameter for name, parameter in found if name == "Revolute Joint2"] == ["type"]
    model.blocks[model.sid("Revolute Joint2")].source = REVOLUTE.replace("Revolute", "Universal")
    found = changed(compared(model, published_leg()))
    assert [parameter for name, parameter in found if name == "Revolute Joint2"] == ["type"]


def test_a_unit_that_measures_something_else(compared):
    model = published_leg().set("Simulink-PS\nConverter2", Unit="m")
    assert changed(compared(model, published_leg())) == [("Simulink-PS Converter2", "Unit")]


def test_a_scope_may_show_another_unit_unless_strict(compared):
    model = published_leg().set("PS-Simulink px", Unit="m")
    found = compared(model, published_leg())
    assert found.agrees
    assert names(found.tolerated) == ["foot positions"]
    assert not compared(model, published_leg(), strict=True).agrees


def test_times_of_the_solver(compared):
    found = compared(published_leg(stop_time="10"), published_leg())
    assert changed(found) == [("(solver)", "StopTime")]


def test_a_model_whose_mechanism_is_not_known_is_a_sentence(compared):
    model = published_leg().set("Brick Solid1", Density="rho")
    with pytest.raises(InvalidValueError, match="'rho'"):
        compared(model, published_leg())


def test_charts_are_compared_by_what_they_do(compared):
    def with_limit(text):
        made = heated(sampled=True)
        block = made.blocks[made.sid("Mode")]
        block.script = block.script.replace("x &gt; 2", text)
        return made

    assert changed(compared(with_limit("x &gt; 2"), with_limit("x  &gt;  2"))) == []
    found = compared(with_limit("x &gt; 2"), with_limit("x &gt; 3"))
    assert [item["why"] for item in found.different] == [
        "its chart has other states, transitions or actions"
    ]
    held = compared(with_limit("x &gt; 2"), with_limit("hasChanged(x)"))
    assert any("content is not compared" in str(item) for item in held.matched)
