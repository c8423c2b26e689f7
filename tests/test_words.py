"""Words in sentences: what is counted, articles, quotation marks."""

from drake_leg.arguments import counted, quoted, some_of, with_article


def test_words_agree_with_their_numbers():
    assert [counted(n, "column") for n in (0, 1, 2)] == ["0 columns", "1 column", "2 columns"]


def test_articles_are_as_they_are_said():
    an = ("S-Function", "Integrator", "XY Graph", "LTI System", "Upsample")
    a = ("Gain", "MATLAB Function", "Unit Delay", "Universal Joint", "From", "6-DOF Joint")
    assert all(with_article(noun) == f"an {noun}" for noun in an)
    assert all(with_article(noun) == f"a {noun}" for noun in a)


def test_backslashes_are_quoted_as_they_are_typed():
    assert quoted(r"C:\Users\leg.step") == r"'C:\Users\leg.step'"


def test_the_first_of_some_names_are_named_and_the_others_counted():
    assert [some_of("abc"[:n], 2) for n in (1, 2, 3)] == ["a", "a, b", "a, b and 1 more"]
    assert some_of(["a", "b"], 5, "; ") == "a; b"
