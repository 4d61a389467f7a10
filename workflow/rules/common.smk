# The few functions that rules of several stages use.

from functools import cache

from swingdown.errors import InputError
from swingdown.pendulum.catalogue import catalogue


def code(script):
    """What the package's files that a script rests on are known by; as a parameter it makes a rule run again when one is edited."""
    return fingerprint(f"{workflow.basedir}/workflow/scripts/{script}.py")


def here(paths):
    """Files of the project itself, which lie on every machine and in no storage."""
    return local(paths) if workflow.storage_settings.default_storage_provider else paths


def raw(name):
    """The input file of a recording, or nothing where a URL is read."""
    file = PLAN.rows[name]["file"]
    return [] if is_url(file) else str(find(file))


def told():
    """The files, beside the recordings, whose checksums the report tells."""
    sheets = [config.get("recordings"), config.get("left_out"), PLAN.apparatus]
    names = [*(workflow.configfiles[:1] if OWN else workflow.configfiles), *sheets]
    return [str(find(name)) for name in names if name]


@cache
def trials():
    """The trials of hidden effects by chunk; what they are drawn with takes a second to import, and most runs hide nothing."""
    from swingdown.trials.schedule import chunks

    with console.job():
        return chunks(config["hidden_effects"], catalogue(config["effects"]))


def only_capture(wildcards):
    """The input of `all` where a recording is asked for: a refusal."""
    key = next(key for key in takes.KEYS if config.get(key))
    with console.job():
        raise InputError(
            f"config, key {key}",
            "a recording is captured by the target `capture` alone, and nothing else runs beside it",
            f"snakemake capture --config {key}={config[key]}",
            "name the target `capture`, or leave recording, session and monitor out",
        )
