"""What is needed to get the same numbers again."""

from .. import provenance
from ..material import Material
from ..page import Column, Section, Table


def origin(material: Material) -> Section:
    """Seed, versions and checksums: what is needed to get the same numbers again."""
    facts = [[name, value] for name, value in provenance.versions(material.settings["seed"])]
    about = Table(
        "Versions", "What computed these results.", [Column("what"), Column("which", style="code")], facts
    )
    files = [[r["recording"], r["file"], r["sha256"]] for r in material.recordings]
    files += [["", name, digest] for name, digest in provenance.checksums(material.inputs)]
    columns = [Column("recording"), Column("file"), Column("SHA-256", style="code")]
    inputs = [Table("Inputs", "Every file the results rest on.", columns, files)] if files else []
    return Section("Provenance", [about, *inputs])
