"""Every language has every text, with the same values in it; a sentence is said whole or stays English; numbers have their decimal sign."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from swingdown.discovery.criterion import Doubt
from swingdown.discovery.see.losses import _SAID
from swingdown.discovery.tell.sentence import _described, _misspecified
from swingdown.errors import InputError
from swingdown.language import capital, language, languages, listed
from swingdown.measurement.judge import Reading
from swingdown.measurement.signal import Interpreted
from swingdown.measurement.units import NO_SCALE, angle_unit, time_factor
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import model_words
from swingdown.plots.pendulums import LOOKS
from swingdown.studies.words import STATUS

OTHERS = [code for code in languages() if code != "en"]
PACKAGE = Path(language.__wrapped__.__code__.co_filename).parent
DOUBTS = [one.format(probability=0.94, share=0.68, parameter="vibration frequency") for one in Doubt]
ENGLISH_WORDS = {"the", "it", "times", "noise", "than", "not", "be"}
FIELD = re.compile(r"\{(\w+)\}")
POINTS_ALONE_TOLD = "points of the motion only: what a torque does between them is not in the data"
NO_SCALE_TOLD = "its readings have no scale: they allow no search, and period and decay alone are reported"


@pytest.fixture(scope="module")
def catalogues():
    return {code: yaml.safe_load((PACKAGE / "languages" / f"{code}.yaml").read_text()) for code in OTHERS}


def shown(what):
    """A text at the beginning of a sentence."""
    return what[0].upper() + what[1:]


@pytest.mark.parametrize("code", OTHERS)
def test_each_effect_is_told_as_missing_as_doubtful_and_as_at_its_bound(code):
    """No sentence of a verdict is left in English."""
    for effect in SHIPPED:
        units = {parameter.name: parameter.unit for parameter in effect.parameters}
        values = {name: {"value": 1.23, "standard_error": 0.02, "unit": units[name]} for name in effect.told}
        one = {"name": effect.name, "tied_with": [], "within_calibration": False, "parameters": values}
        said = _described(one, effect)
        sentences = [
            f"{shown(said)} is missing (P > 0.999): without it 3.22 times the noise remains, with it 1.11."
        ]
        sentences += [f"It may be {said}: not sure enough to be named ({doubt})." for doubt in DOUBTS]
        sentences += (
            [_misspecified({"misspecified": [effect.size.name], "status": "partial"}).strip()]
            if effect.size
            else []
        )
        for sentence in sentences:
            assert not ENGLISH_WORDS & set(language(code).text(sentence).split()), sentence


@pytest.mark.parametrize("code", OTHERS)
@pytest.mark.parametrize(
    "where", ["", "at amplitudes above 19° ", "at amplitudes below 8.3° ", "at amplitudes from 8.3° to 21° "]
)
def test_where_a_model_disagrees_is_told(code, where):
    for seen in np.ravel(list(_SAID.values())):
        told = language(code).text(f"{shown(where + seen)}.")
        assert not ENGLISH_WORDS & set(told.split()), told
        assert ("8.3" in where) == ("8,3" in told) and told.endswith(".")


@pytest.mark.parametrize("code", OTHERS)
def test_verdicts_are_told_alone_in_a_list_in_a_legend_and_before_a_remark(code):
    told = language(code).text
    verdicts = [*STATUS.values(), *(words for *_, words in LOOKS.values())]
    for words in verdicts:
        assert told(words).lower() == told(words.lower()).lower() != words.lower(), words
    first, second = (told(words) for words in ("Nothing is missing", "not searched"))
    listed = told("Nothing is missing: 4, not searched: 2; 2 files could not be used.")
    assert listed.startswith(first) and second in listed and "used" not in listed
    remarks = POINTS_ALONE_TOLD, NO_SCALE_TOLD
    assert all(not ENGLISH_WORDS & set(told(f"Not searched: {one}").split()) for one in remarks)
    assert told("could not be used: 1.5.csv, b").endswith(": 1.5.csv, b")


def test_there_are_five_beside_english():
    assert set(OTHERS) == {"de", "es", "fr", "it", "pt"} and languages()[0] == "en"


def test_all_have_the_same_texts_with_the_same_values(catalogues):
    first = catalogues["de"]["texts"]
    for code, one in catalogues.items():
        assert one["texts"].keys() == first.keys(), code
        for key, text in one["texts"].items():
            fields = [{name.lower() for name in FIELD.findall(each)} for each in (key, text)]
            assert fields[0] == fields[1] and text.strip(), f"{code}: {key}"
            assert (
                not set(FIELD.findall(text))
                - set(FIELD.findall(key))
                - {name.lower() for name in FIELD.findall(key) if name[0].isupper()}
            ), f"{code}: {key}"


def said_in_the_package():
    """All that the package says, with a 1 for every value: texts, templates, names of effects and of their parameters."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        inner = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = [one.value if isinstance(one, ast.Constant) else "1" for one in node.values]
                inner |= {id(one) for one in node.values}
                found.add("".join(map(str, parts)))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inner:
                found.add(re.sub(r"\{[^{}]*\}", "1", node.value))
    for path in [
        *PACKAGE.rglob("*.j2"),
        *PACKAGE.rglob("*.js"),
        *(PACKAGE.parents[1] / "report").glob("*.rst"),
    ]:
        found.add(" ".join(path.read_text(encoding="utf-8").split()))
    for name in SHIPPED.names:
        found |= {model_words(name), *(one.name.replace("_", " ") for one in SHIPPED[name].parameters)}
    return found | {text.replace("_", " ") for text in found}


def test_every_text_that_is_translated_is_one_that_the_program_says(catalogues):
    """A wording that changes in the code and not in the catalogues would silently be English in every language."""
    said = {text.lower() for text in said_in_the_package()}
    lost = []
    for key in catalogues["de"]["texts"]:
        inner = re.sub(r"with --(\w+)", r"⟨in \1⟩", key)  # an option of the command, as messages name it
        words = [part.lower() for part in FIELD.split(inner)[::2]]
        # of a sentence that is put together from parts, the part that says most
        longest = max(re.split(r"[:;,()]| and |\b(?:at|from) ", max(words, key=len)), key=len).strip(" .?")
        if "1".join(words) not in said and (len(longest) > 4 and not any(longest in text for text in said)):
            lost.append(key)
    assert not lost


@pytest.mark.parametrize(
    ("code", "english", "told"),
    [
        (
            "de",
            "Air drag (viscous) and bearing friction stop it: T = 0.87147(30) s, Q = 58.0(3.5). Nothing else is needed.",
            "Luftwiderstand (viskos) und Lagerreibung bremsen die Schwingung: T = 0,87147(30) s und Q = 58,0(3,5). Mehr ist nicht nötig.",
        ),
        (
            "de",
            "T goes as the power 0.45(1) of length; theory says 0.5, which does not agree (4.1 standard uncertainties away); "
            "g = 9.87 ± 0.01 m/s² by the slope of T² over the length; the lengths are too short by 2.5(2) mm, all alike",
            "T geht mit der Potenz 0,45(1) der Größe Länge; die Theorie sagt 0,5, das stimmt nicht überein (4,1 Standardunsicherheiten entfernt); "
            "g = 9,87 ± 0,01 m/s² aus der Steigung von T² über der Länge; die Längen sind alle gleich um 2,5(2) mm zu kurz",
        ),
        (
            "it",
            "period of small swings by group: group 4 does not agree with the others, which agree with each other (chi² 512 for 5, p below 1e-9 for all)",
            "periodo delle piccole oscillazioni per gruppo: group 4 non concorda con gli altri, che concordano tra loro (χ² 512 per 5, p minore di 1e-9 per tutti)",
        ),
        (
            "fr",
            "Bearing friction stops it: T = 1.5(1) s.",
            "Le frottement du palier amortit l'oscillation\u00a0: T = 1,5(1) s.",
        ),
        (
            "es",
            "What stops it is not established; air drag (viscous), bearing friction and dry friction come nearest: Q = 3.1(2).",
            "No está establecido qué amortigua la oscilación; la resistencia del aire (viscosa), el rozamiento del cojinete y el rozamiento seco "
            "son lo que más se acerca: Q = 3,1(2).",
        ),
        ("it", "What stops it cannot be told: it does not die away. T = 1.03 s.", "Non si può dire che cosa smorzi l'oscillazione: non si estingue. T = 1,03 s."),
        ("pt", "Dry friction stops it.", "O atrito seco amortece a oscilação."),
        (
            "de",
            "Presliding (angle 6.1 ± 0.2 mrad), or backlash, which the data do not distinguish, is missing (P > 0.999): without it 1.55 times the noise "
            "remains, with it 1.06.",
            "Es fehlt: elastische Haftung (presliding) (Winkel 6,1 ± 0,2 mrad) oder Spiel, was die Daten nicht unterscheiden, (P > 0,999). Ohne das "
            "bleibt das 1,55-fache des Rauschens, damit das 1,06-fache.",
        ),
        ("de", "at 20.1°", "bei 20,1°"),
        ("es", "quality by group: left and right do not agree (chi² 3.5 for 1, p = 0.006)", "factor de calidad por grupo: left y right no concuerdan (χ² 3,5 con 1, p = 0,006)"),
        ("de", "if it is viscous and load Coulomb (P 0.823)", "falls die Dämpfung so ist: viskos und Coulomb (lastabhängig) (P 0,823)"),
        (
            "pt",
            "it begins in a hand and was released at about 0.36 s: the swing is used from 0.555 s on (--start says otherwise)",
            "começa numa mão, que o larga por volta de 0,36 s: usa-se a oscilação a partir de 0,555 s (--start diz outra coisa)",
        ),
        (
            "fr",
            "length as the names say: l=0.20 m → 0.2 m, 25.5cm → 0.255 m, 30cm → 0.3 m …",
            "longueur d'après les noms : l=0.20 m → 0,2 m, 25.5cm → 0,255 m, 30cm → 0,3 m …",
        ),
        (
            "de",
            "T goes as the power 0.47(11) of length, beside an error that all lengths share; without one the power is 0.396(11)",
            "T geht mit der Potenz 0,47(11) der Größe Länge, neben einem Fehler, den alle Längen gemeinsam haben; ohne ihn ist die Potenz 0,396(11)",
        ),
    ],
)  # fmt: skip
def test_sentences_are_whole(code, english, told):
    assert language(code).text(english) == told


def test_what_no_catalogue_has_stays_english_sentence_by_sentence():
    spoken = language("de")
    assert (
        spoken.text("A badger stops it: T = 1.5 s. Nothing else is needed.")
        == "A badger stops it: T = 1.5 s. Mehr ist nicht nötig."
    )
    assert spoken.text("anna.1.2 and bearing friction") == "anna.1.2 and bearing friction"
    assert language("en").text("Bearing friction stops it.") == "Bearing friction stops it."


@pytest.mark.parametrize(
    ("text", "told"),
    [("0.87147(30)", "0,87147(30)"), ("58.0(3.5)", "58,0(3,5)"), ("1.23(4) × 10⁻⁵", "1,23(4) × 10⁻⁵"), ("swingdown 0.1.0", "swingdown 0.1.0"), ("a1.5b.csv", "a1.5b.csv"), ("(1.20 ± 0.34)e-7", "(1,20 ± 0,34)e-7"), ("3.12e+04", "3,12e+04"), ("1.5e-3.csv", "1.5e-3.csv")],
)  # fmt: skip
def test_numbers_have_the_decimal_sign_of_the_language(text, told):
    assert language("fr").number(text) == told and language("en").number(text) == text


def test_an_unknown_language_is_refused_with_those_that_there_are():
    with pytest.raises(InputError, match="de, es, fr, it, pt"):
        language("nl")


@pytest.mark.parametrize("code", OTHERS)
def test_what_a_file_without_units_was_taken_for_is_told(code):
    """The line on how a file was read, and the remarks on its units."""
    t = np.arange(0.0, 30.0, 0.02)
    x = 72 * np.exp(-t / 20) * np.cos(2 * np.pi * t / 1.4)
    layout = "rows in brackets, `,`, no header, 1500 samples"
    read = ("`x`", "", "`t` as MS (no unit is stated)", "50.0 samples a second", layout)
    told = [
        Interpreted(t, x, Reading(unit, False), [], {}, "x", read=read).taken(Reading(unit, False))
        for unit in ("rad", "deg", NO_SCALE)
    ]
    told += time_factor(1000 * t, x, False, "here")[1] + time_factor(1000 * t, x, False, "here", "taken")[1]
    told += angle_unit(x, "", "sine", "here")[1]
    assert len(told) == 6
    for english in told:
        assert not {"took", "unit", "of", "brackets,", "samples"} & set(language(code).text(english).split())


@pytest.mark.parametrize(("words", "told"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")])  # fmt: skip
def test_words_stand_one_after_the_other(words, told):
    assert listed(words) == told


@pytest.mark.parametrize(("words", "told"), [("dry friction", "Dry friction"), ("γ goes as", "γ goes as"), ("g = 9.81", "g = 9.81"), ("a disc", "A disc"), ("gain", "Gain"), ("", "")])  # fmt: skip
def test_a_sentence_begins_with_a_capital_and_a_symbol_stays_one(words, told):
    assert capital(words) == told


@pytest.mark.parametrize("code", OTHERS)
def test_what_is_not_looked_at_is_told(code):
    for why in ("a picture is no recording", "files that end in .log are none of recordings", "files without an ending are none of recordings"):  # fmt: skip
        told = language(code).text(f"notes 1.5: not looked at: {why}")
        assert told.startswith("notes 1.5") and not {"looked", "files", "are", "recording"} & set(
            told.split()
        )
