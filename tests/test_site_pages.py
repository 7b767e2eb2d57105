"""Pages of the site that are made from the program: tasks, measured tables, versions."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tasks.registry import TASKS
from tools.docs.html.for_everybody import for_everybody
from tools.docs.measured_tables import MeasuredTable, tables_of
from tools.docs.owner import BEGINNINGS, CLONED, with_address
from tools.docs.task_films import FILMS, film_of
from tools.docs.versions import released

ROOT = Path(__file__).parents[1]

pytest.importorskip("gymnasium")


def measured() -> list[MeasuredTable]:
    return list(tables_of(ROOT / "docs" / "results.md"))


def test_a_task_that_is_a_column_gives_its_rows_and_their_names(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# Title\n\n## Part\n\n| | a | b |\n| --- | --- | --- |\n| x | 1 | 2 |\n", "utf-8"
    )
    [table] = tables_of(page)
    part = table.of_task("b")
    assert part is not None
    assert (part.heading, part.columns, part.rows) == ("Part", ("", "b"), (("x", "2"),))
    assert table.of_task("c") is None


def test_a_task_in_cells_gives_its_rows_without_its_name(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "| robot | task | n |\n| --- | --- | --- |\n| r | a | 1 |\n| r | b | 2 |\n", "utf-8"
    )
    [table] = tables_of(page)
    part = table.of_task("b")
    assert part is not None
    assert (part.columns, part.rows) == (("robot", "n"), (("r", "2"),))


@pytest.mark.parametrize("name", TASKS)
def test_the_page_of_a_task_has_its_contract_its_spaces_and_what_was_measured(name: str) -> None:
    from tools.docs.task_pages import described, page_of

    kind, tables = TASKS[name], measured()
    page = page_of(kind, tables)
    told = described(kind)
    assert all(text[1:] in page for text in (told.first, told.more, *told.parts.values()))
    words = "".join(word.capitalize() for word in name.split("-"))
    assert f"`hand_sandbox/{words}-v{kind.version}`" in page
    assert f"| Time limit | {kind.time_limit:g} s |" in page
    rows = [row for table in tables if (part := table.of_task(name)) for row in part.rows]
    assert all(f"| {without_targets(' | '.join(row))} |" in without_targets(page) for row in rows)


def without_targets(text: str) -> str:
    """A text in Markdown whose links name no target."""
    return re.sub(r"\]\([^)]*\)", "]", text)


def test_links_in_a_measured_cell_lead_on_the_page_of_a_task_where_they_led() -> None:
    from tools.docs.task_pages import page_of

    cell = "now [here](#part), [there](physics.md#kinds), [far](https://x.org/), [up](../run.md)"
    table = MeasuredTable(Path("results.md"), "Part", ("", "dial"), ((cell, "1"),))
    page = page_of(TASKS["dial"], [table])
    assert (
        "now [here](../docs/results.md#part), [there](../docs/physics.md#kinds), "
        "[far](https://x.org/), [up](../docs/../run.md)"
    ) in page


@pytest.mark.parametrize("name", TASKS)
def test_no_link_on_the_page_of_a_task_is_to_a_heading_that_it_lacks(name: str) -> None:
    from tools.docs.task_pages import page_of

    assert "](#" not in page_of(TASKS[name], measured())


def test_every_film_is_of_a_task_and_one_a_task() -> None:
    films = [film for name in TASKS if (film := film_of(name))]
    assert sorted(film.path for film in films) == sorted(FILMS.glob("*.webp"))


def test_released_versions_are_the_tags_newest_first(tmp_path: Path) -> None:
    def git(*words: str) -> None:
        named = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        subprocess.run(["git", *named, *words], cwd=tmp_path, check=True, capture_output=True)

    git("init")
    git("commit", "--allow-empty", "-m", "one")
    for tag in ("v0.9.0", "v0.10.0", "v0.2.0", "vwrong", "v1.0.0-draft"):
        git("tag", tag)
    assert released(tmp_path) == ["0.10.0", "0.9.0", "0.2.0"]


@pytest.mark.parametrize("name", BEGINNINGS)
def test_pages_to_begin_with_say_how_to_clone_by_the_address_once_there_is_one(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert CLONED in text and with_address(text, "") == text
    known = with_address(text, "https://example.org/hand-sandbox")
    assert "git clone https://example.org/hand-sandbox hand-sandbox" in known
    assert "ADDRESS" not in known and "no public address" not in known


TABLE = '<div class="table-wrapper docutils container"><table><td><p>{}</p></td></table></div>'


def test_every_table_of_a_page_has_a_name_of_its_own_and_keys_reach_it() -> None:
    cell = TABLE.format("1")
    page = f"<h2>Spaces<a>¶</a></h2>{cell}<p><a>Every &lt;task&gt;</a>:</p>\n{cell}<p>So.</p>{cell}"
    found = re.findall(r'<div tabindex="0" role="group" aria-label="([^"]*)"', for_everybody(page))
    assert found == [
        "Table: Spaces, 1 of 2",
        "Table: Every &lt;task&gt;",
        "Table: Spaces, 2 of 2",
    ]
    assert for_everybody("<p>no table</p>") == "<p>no table</p>"


@pytest.mark.parametrize(
    ("code", "shown"),
    [
        ("--seeds", "--seeds"),
        ("hand_sandbox/CarryTogether-v1", "hand_sandbox/<wbr>CarryTogether-v1"),
        ("serial|processes|ray,x", "serial|<wbr>processes|<wbr>ray,<wbr>x"),
        ("noticeable_drop_with_churn", "noticeable_<wbr>drop_<wbr>with_<wbr>churn"),
        ("a&lt;b&gt;c&lt;d&gt;", "a&lt;b&gt;c&lt;d&gt;"),
    ],
)
def test_long_code_in_cells_is_broken_between_its_parts_alone(code: str, shown: str) -> None:
    whole = f'<code><span class="pre">{code}</span></code>'
    assert f">{shown}</span>" in for_everybody(TABLE.format(whole))
    assert f">{code}</span>" in for_everybody(f"<p>{whole}</p>")


def test_cells_of_prose_are_marked() -> None:
    assert '<td class="prose"><p>word' in for_everybody(TABLE.format("word " * 20))
    assert "prose" not in for_everybody(TABLE.format("word"))


@pytest.mark.parametrize("name", TASKS)
def test_links_to_what_was_measured_are_told_apart(name: str) -> None:
    from tools.docs.task_pages import page_of

    links = re.findall(r"^\[(.*)\]\(\.\./docs/results\.md", page_of(TASKS[name], measured()), re.M)
    assert len(set(links)) == len(links)
