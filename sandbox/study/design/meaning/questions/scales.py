"""Scales whose score says nothing: of unlike or opposite items, or of a check of reading."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from sandbox.study.design.design import Design, Form, Item
from sandbox.study.design.meaning.questions.polarity import direction
from sandbox.study.design.scoring import Scale
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, asked_forms, is_own
from sandbox.study.design.toml_lines import Path

_GIVEN = (
    r"(?<! to )(?<! bis )(?<! a )(?<! al )(?<! tot )(?<! ate )(?<! and )(?<! und )(?<!-)(?<!–)"
    r"(\d+|{words})\b(?! ?(=|-|–|\(|(?:{explains})\b))"
)
"""An answer that is asked for; not one that is explained, as in "mark 1 for never"."""


def _given(words: str, explains: str) -> str:
    return _GIVEN.format(words=words, explains=explains)


CHECKS = Phrases(
    {
        "en": (
            r"(?<!you )(?<!to )(?<!could )(?<!can )(?<!i )(mark|select|choose|click|tick|pick|tap|"
            r"press|enter|answer|move|set)\b (\w+,? ){0,6}?"
            r"[\"'“‘]?"
            + _given(
                "two|three|four|five|six|seven|strongly|leftmost|rightmost|lowest|highest",
                "for|if|when|means?|to|or|and|of|times",
            )
            + r"|(show|check|prove|verify|make sure|see|test|ensure|confirm)\w* (us )?(that |if |"
            r"whether )?you (are|were|re|have|really|actually|do|still) ?(\w+ )?(reading|read|"
            r"paying|pay|attentive|awake)|attention check|control question|leave this (item|"
            r"question|one) (blank|empty|as it is)|do not answer this|quality (control|check)|"
            r"leave (this|it|the slider)\b[^.?]* (blank|empty|as it is|at \d|on \d)|(?<!you "
            r")(?<!to )(choose|select|click|answer|pick|mark|tick)\b[^.?]{0,40}\b(first|last|"
            r"leftmost|rightmost|far (left|right)) (answer|option|box|point|value)|(?<!you )(?<!to "
            r")(choose|select|answer|pick|mark|tick)\b (\w+ ){0,3}['“‘][\w ]+['”’](?! ?(if|when|"
            r"for))"
        ),
        "de": (
            r"(kreuzen|wahlen|markieren|klicken|tippen|geben|stellen|antworten|setzen|schieben|"
            r"drucken)\b sie (\w+,? ){0,6}?[\"'“„»]?"
            + _given(
                "zwei|drei|vier|funf|sechs|sieben|stimme|trifft|niedrigste\\w*|hochste\\w*",
                "fur|wenn|falls|bedeutet|bis|oder|und|mal",
            )
            + r"|(zeigen|prufen|kontroll\w*|sicherstell\w*|uberpruf\w*|sicher ?gehen)[^.?]*"
            r"(aufmerksam|lesen|gelesen)|aufmerksamkeits(test|prufung|kontrolle)|kontrollfrage|"
            r"kreuzen sie hier|zur kontrolle|(hier|bitte)\b[^.?]*\b(links|rechts|(?<!bis )\d+) "
            r"(an(kreuzen|"
            r"klicken|tippen)|(aus)?wahlen|markieren)|(wahlen|markieren|klicken|kreuzen) sie "
            r"[^.?]{0,40}(erste|letzte|ausserst|ganz (links|recht))"
        ),
        "fr": (
            r"(cochez|choisissez|selectionnez|marquez|cliquez|indiquez|repondez|mettez|appuyez|"
            r"placez)\b (\w+,? ){0,6}?[\"'“«]? ?"
            + _given(
                "deux|trois|quatre|cinq|six|sept|tout a fait|pas du tout",
                "pour|si|quand|signifie|a|ou|et|fois",
            )
            + r"|(verifi|montr|prouv|control|assur)\w* que vous (\w+ )?(lisez|etes attenti|avez lu|"
            r"suivez)|question de controle|test d'attention|(merci de|veuillez|priere de|il faut) "
            r"(cocher|choisir|selectionner|marquer|cliquer|repondre|indiquer)|(cochez|choisissez|"
            r"cliquez|selectionnez)\b [^.?]{0,40}(premiere|derniere|tout a (gauche|droite))"
        ),
        "es": (
            r"(marque|elija|seleccione|escoja|pulse|indique|responda|ponga|marca|elige|selecciona|"
            r"escoge|pulsa)\b (\w+,? ){0,6}?[\"'“«]?"
            + _given(
                "dos|tres|cuatro|cinco|seis|siete|muy|nada",
                "para|si|cuando|significa|al?|hasta|o|y|veces",
            )
            + r"|(comprob|verific|demostr|mostr|muestr|asegur|compruebe)\w* que (\w+ ){0,2}?(lee|"
            r"leyendo|leido|lees|atent|presta|atencion)\w*|pregunta de control|control de atencion|"
            r"control de calidad|si (usted )?(esta|estas) leyendo|(marque|elija|seleccione|pulse|"
            r"escoja)\b [^.?]{0,40}((primera|ultima) (opcion|respuesta|casilla)|la (izquierda|"
            r"derecha))"
        ),
        "it": (
            r"(segni|scelga|selezioni|clicchi|indichi|prema|risponda|metta|barri|tocchi)\b "
            r"(\w+,? ){0,6}?[\"'“«]?"
            + _given("due|tre|quattro|cinque|sei|sette", "per|se|quando|significa|a|o|e|volte")
            + r"|(verific|dimostr|controll|assicur)\w* che (\w+ ){0,2}?(legg|letto|attent)\w*|"
            r"domanda di controllo"
        ),
        "nl": (
            r"(kies|selecteer|markeer|klik|vink|druk|zet|antwoord|kruis|tik)\b (\w+,? ){0,6}?"
            r"[\"'“‘]?"
            + _given("twee|drie|vier|vijf|zes|zeven", "voor|als|wanneer|betekent|tot|of|en|keer")
            + r"|(controleren|zien|nagaan|tonen)[^.?]*(leest|gelezen|oplet|aandacht)|controlevraag"
        ),
        "pt": (
            r"(marque|escolha|selecione|clique|indique|responda|ponha|assinale)\b (\w+,? ){0,6}?"
            r"[\"'“«]?"
            + _given("dois|tres|quatro|cinco|seis|sete", "para|se|quando|significa|a|ou|e|vezes")
            + r"|(verific|mostr|comprov|certific)\w* que (\w+ ){0,2}?(le|lendo|leu|atent)\w*"
        ),
        "zh": (
            r"请(在此|在这里|务必|直接)?(选|点击|标记|勾选)[^。]{0,8}[0-9一二三四五六七]|"
            r"注意力(检查|测试|检测)|(检查|证明|确认|确保)[^。]*(阅读|认真)"
        ),
        "ja": (
            r"[0-9一二三四五六七](番)?(を|に)(選|クリック|押|マーク|タップ|印)|注意(力)?(チェック|"
            r"確認)|(読んで|読まれて)[^。]*(確認|確かめ)"
        ),
        "ar": r"(اختر|اختاري|ضع|حدد|علم)[^.]{0,20}[0-9٠-٩]|للتحقق من (أنك|انك|انتباه)",
    }
)
"""Questions that check whether people read; their answer is given."""
_NAMED = re.compile(
    r"\b(?:attention|catch|trap|instructed|instructional|control)[ _-]?(?:check|item|question|"
    r"trial)s?\b|aufmerksamkeits?(?:test|check)|kontrollfrage|\bimc\b|controlevraag"
)


def scale_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the scales of questionnaires, one line for each cause."""
    for path, form in asked_forms(design):
        items = {item.name: item for item in form.items}
        for i, scale in enumerate(form.scales):
            used = [items[name] for name in scale.items]
            place = (*path, "scales", i)
            yield from _checks(place, scale, used)
            yield from _ranges(place, scale, used)
            yield from _pairs(place, scale, items)
            if is_own(form):
                yield from _opposite(design, place, scale, used)
        if is_own(form):
            yield from _by_language(design, path, form)


def is_check(item: Item) -> bool:
    """True if a question only checks whether people read."""
    return _NAMED.search(plain(item.name)) is not None or any(
        CHECKS.match(text, language) for language, text in item.ask.items()
    )


def _checks(path: Path, scale: Scale, items: list[Item]) -> Iterator[Flaw]:
    checks = [item.name for item in items if is_check(item)]
    if checks:
        one = checks[0]
        yield Flaw(
            (*path, "items"),
            f"{one} checks whether people read, and counts in the score of {scale.name}",
            f"Remove {one} from `items`, and keep the question",
        )


def _ranges(path: Path, scale: Scale, items: list[Item]) -> Iterator[Flaw]:
    """Answers of unlike ranges: the widest one decides the score."""
    spans = {item.name: item.high - item.low for item in items}
    if len(set(spans.values())) > 1 and any(item.kind == "scale" for item in items):
        widest, least = max(items, key=_span), min(items, key=_span)
        yield Flaw(
            (*path, "items"),
            f"{widest.name} goes from {widest.low:g} to {widest.high:g}, and {least.name} from "
            f"{least.low:g} to {least.high:g}, so that the score of {scale.name} is mostly that of "
            f"{widest.name}",
            "Give all items the same low and high, or make a scale of each",
        )


def _pairs(path: Path, scale: Scale, items: dict[str, Item]) -> Iterator[Flaw]:
    """Weights from comparisons in which some items occur more often than others."""
    if not scale.pairs:
        return
    met = Counter(name for pair in scale.pairs for name in items[pair].choices)
    most, least = max(scale.items, key=lambda n: met[n]), min(scale.items, key=lambda n: met[n])
    if met[most] != met[least]:
        yield Flaw(
            (*path, "pairs"),
            f"{most} is in {met[most]} comparisons of {scale.name}, and {least} in "
            f"{met[least]}, so that their weights are no fair ones",
            "Compare every item with each other one, once",
        )


def _span(item: Item) -> float:
    return item.high - item.low


def _opposite(design: Design, path: Path, scale: Scale, items: list[Item]) -> Iterator[Flaw]:
    """Items that run against the others of their scale, and are not reversed, or needlessly."""
    for language in design.languages:
        ways = {
            item.name: direction(item.ask[language], item.ends, language)
            * (-1 if item.name in scale.reverse else 1)
            for item in items
            if not is_check(item)
        }
        up = [name for name, way in ways.items() if way > 0]
        down = [name for name, way in ways.items() if way < 0]
        if not up or not down:
            continue
        first = next(name for name, way in ways.items() if way)
        turned = (down if first in up else up) if len(up) == len(down) else min(up, down, key=len)
        reverse = sorted(scale.reverse ^ set(turned), key=scale.items.index)
        others = down if turned is up else up
        listed = ", ".join(f'"{name}"' for name in reverse)
        yield Flaw(
            (*path, "reverse") if scale.reverse else path,
            f"{' and '.join(turned)} run against {' and '.join(others)}, so that they cancel out "
            f"in the score of {scale.name}",
            f"Write reverse = [{listed}]" if reverse else "Remove `reverse`",
        )
        return


def _by_language(design: Design, path: Path, form: Form) -> Iterator[Flaw]:
    """Questions that ask for opposite things in two languages, with the same ends."""
    for i, item in enumerate(form.items):
        if item.kind != "scale" or len(design.languages) < 2:
            continue
        ways = {code: direction(item.ask[code], item.ends, code) for code in design.languages}
        ends = {code: direction("", item.ends, code) for code in design.languages}
        up = next((code for code, way in ways.items() if way > 0 and not ends[code]), None)
        down = next((code for code, way in ways.items() if way < 0 and not ends[code]), None)
        if up is not None and down is not None:
            yield Flaw(
                (*path, "items", i, "ask"),
                f"{item.name} asks for opposite things: {item.ask[up]!r} in {up}, and "
                f"{item.ask[down]!r} in {down}",
                "Ask for the same in all languages",
            )
