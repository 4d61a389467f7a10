# The few functions that rules of several stages use.

import re
from functools import cache
from hashlib import sha256

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
    return [] if is_url(file) else nameable([str(find(file))])


def nameable(paths):
    """Those of the paths that can be inputs: Snakemake takes `{7}` in a name for a wildcard and `<a>` for a variable, always."""
    return [path for path in paths if not re.search(r"\{[^{}]+\}|<[^<>]+>", path)]


def unnamed(name):
    """What a recording's file that cannot be an input is known by, so that its rule runs again when it changes."""
    file = PLAN.rows[name]["file"]
    return "" if is_url(file) or raw(name) else sha256(find(file).read_bytes()).hexdigest()


def told():
    """The files, beside the recordings, whose checksums the report tells."""
    sheets = [config.get("recordings"), config.get("left_out"), PLAN.apparatus]
    names = [*(workflow.configfiles[:1] if OWN else workflow.configfiles), *sheets]
    return nameable(str(find(name)) for name in names if name)


@cache
def trials():
    """The trials of hidden effects by chunk; what they are drawn with takes a second to import, and most runs hide nothing."""
    from swingdown_trials.schedule import chunks

    with console.job():
        return chunks(config["hidden_effects"], catalogue(config["effects"]))


def made(part):
    """What a part makes; of hidden effects what each chunk of campaigns does, too."""
    if part != "hidden_effects":
        return MADE_OF[part]
    files = [
        "truth/{chunk}.json",
        "verdicts/{chunk}.json",
        "campaigns/{chunk}/sheet.csv",
        "campaigns/{chunk}/excluded.json",
    ]
    return MADE_OF[part] + expand("results/hidden_effects/{file}", file=expand(files, chunk=trials()))


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
