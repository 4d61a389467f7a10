"""The ways through a tree of settings, for tests that put anything anywhere."""


def paths(content, before=()):
    """The way to every key and every entry of a list."""
    entries = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    for key, one in entries:
        yield (*before, key)
        yield from paths(one, (*before, key))
