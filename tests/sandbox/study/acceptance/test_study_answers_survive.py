"""What somebody writes comes back from the tables as it was, and no reader takes it for another
thing."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.study.design.design import Item
from sandbox.study.record.journal import Journal, read_journal
from sandbox.study.record.pseudonym import new_pseudonym, read_pseudonym
from sandbox.study.run.answers import check_answer, read_answer
from sandbox.study.run.controls import parse_command
from sandbox.study.tables.column import csv_bytes
from tests.support.in_r import in_r

TEXT = Item("why", "text", {"en": "Why?"})
LETTERS = st.characters(exclude_categories=["Cs"], exclude_characters="\0")


HARD = ["007", "NA", "TRUE", "-0", "1e5", "=1+1", '"', "a\nb", "\u2028", "\U0001f600" * 2000]
"""Answers that readers of tables are known to change."""


@given(st.lists(st.text(LETTERS, min_size=1), min_size=1, max_size=5))
@settings(max_examples=60, deadline=None)
@example(HARD)
def test_an_answer_is_in_the_journal_and_in_the_table_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, texts: list[str]
) -> None:
    kept = [check_answer(TEXT, text[:2000]) for text in texts]
    path = tmp_path_factory.mktemp("answers") / "session.jsonl"
    journal = Journal(path)
    for answer in kept:
        journal.append("command", command="note", text=answer)
    journal.close()
    stored = [record["text"] for record in read_journal(path)]
    assert stored == kept
    data = csv_bytes([{"answer": answer} for answer in stored], ["answer"])
    found = pd.read_csv(io.BytesIO(data), dtype=str, keep_default_na=False, skip_blank_lines=False)
    # Readers end a line at a carriage return; it is a line feed in tables.
    told = [(a or "").replace("\r\n", "\n").replace("\r", "\n") for a in kept]
    assert list(found["answer"]) == told


@pytest.mark.needs("r")
def test_r_reads_from_the_table_what_was_written(tmp_path: Path) -> None:
    rng = np.random.default_rng(13)
    codes = np.arange(1, 0x110000)
    letters = codes[((codes < 0xD800) | (codes >= 0xE000)) & (codes != ord("\r"))]
    texts = [*HARD, " ", "#", "'", "\\", "\t", "a,b", "N/A", "0x1F", "1L", "T", "1i"]
    texts += ["".join(map(chr, rng.choice(letters, rng.integers(1, 12)))) for _ in range(2000)]
    rows = [{"n": n, "answer": text} for n, text in enumerate(texts)]
    path = tmp_path / "answers.csv"
    path.write_bytes(csv_bytes(rows, ["n", "answer"]))
    script = "for (a in words(given[[1]])$answer) cat(paste(charToRaw(a), collapse = ''), '\\n')"
    found = [bytes.fromhex(line).decode() for line in in_r(script, path)]
    assert found == texts


@pytest.mark.parametrize("text", ["\0", "a\0b", "\ud83d", "x\udc00"])
def test_a_letter_that_tables_cannot_keep_is_refused_where_it_is_typed(
    text: str, tmp_path: Path
) -> None:
    for check in (check_answer, read_answer):
        with pytest.raises(StudyError, match="tables cannot store"):
            check(TEXT, text)
    assert "tables cannot store" in str(parse_command(f"n {text}!"))
    journal = Journal(tmp_path / "session.jsonl")
    with pytest.raises(StudyError, match="tables cannot store"):
        journal.append("command", command="note", reason={"why": [text]})
    assert journal.records == [] and not (tmp_path / "session.jsonl").read_bytes()
    journal.append("command", command="note", text="a backslash before u0000: \\u0000")
    assert read_journal(tmp_path / "session.jsonl") == journal.records
    journal.close()


@pytest.mark.needs("r")
def test_r_takes_no_pseudonym_for_a_number_or_a_truth(tmp_path: Path) -> None:
    path = tmp_path / "names.csv"
    path.write_text("ppid\n" + "\n".join(new_pseudonym() for _ in range(20_000)))
    script = """
    names <- read.csv(given[[1]])$ppid
    one <- vapply(names[1:2000], function(x) class(type.convert(x, as.is = TRUE)), "")
    cat(class(names), unique(one), all(is.na(suppressWarnings(as.complex(names)))))
    """
    assert in_r(script, path) == ["character character TRUE"]


def test_no_reader_takes_a_pseudonym_for_a_number_or_a_date() -> None:
    names = [new_pseudonym() for _ in range(20_000)]
    assert list(pd.read_csv(io.StringIO("ppid\n" + "\n".join(names)))["ppid"]) == names
    for name in names[:1000]:
        assert name[0].isalpha() and read_pseudonym(name.lower()) == name
        with pytest.raises(ValueError, match="could not convert"):
            float(name)
