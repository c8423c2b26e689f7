"""From a robot's Khalil table to a verified, simulated, shown model, on Drake."""


def __getattr__(name: str) -> str:
    if name == "__version__":
        from importlib.metadata import version

        return version("drake-leg")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
