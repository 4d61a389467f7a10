"""How models are called on the page."""

from swingdown.report.wording import groups, model_symbol, with_symbols


def test_a_models_symbol_has_its_effects_as_subscript_and_the_bounds_are_words():
    assert model_symbol("viscous+quadratic_drag") == "κ<sub>v,q</sub>"
    assert model_symbol("error_bounds") == "error bounds"


def test_symbols_in_a_sentence_are_typeset_and_all_else_is_text():
    assert with_symbols("κv,q & κc, both") == "κ<sub>v,q</sub> &amp; κ<sub>c</sub>, both"


def test_a_group_begins_wherever_the_label_changes():
    assert groups(["a", "a", "b", "b", "a"]) == (2, 4)
    assert groups(["a", "b"]) == (1,) and groups(["a"]) == () and groups([]) == ()
