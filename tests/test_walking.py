import numpy as np

from drake_leg import simulate, walking


def test_every_name_has_a_help_of_its_own():
    for name in walking.__all__:
        value = getattr(walking, name)
        assert not callable(value) or value.__doc__, name


def test_a_walk_in_parts_is_as_its_module_shows():
    lines = walking.__doc__.partition("::\n\n")[2]
    code = "\n".join(line[4:] for line in lines.splitlines()).replace("5.0", "0.2")
    told = {"simulate": simulate}
    exec(code.replace("print(", "place = ("), told)
    np.testing.assert_allclose(told["place"][4:], [0.0, 0.0, 0.085], atol=1e-3)
