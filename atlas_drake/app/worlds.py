"""What ``--help`` says about the worlds that come with the package."""


def worlds_told() -> str:
    """Return a sentence with their names and what there is to see."""
    # Drake loads only for those who ask.
    from atlas_drake.scenario.world_file import available_worlds, load_world

    told = [f"{name} ({load_world(name).description})" for name in available_worlds()]
    return f"Worlds: {', '.join(told)}."
