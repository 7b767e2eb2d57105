"""Sound designs in several languages, of which tests change one thing."""

from __future__ import annotations

from pathlib import Path

from sandbox.study.design.design_file import parse_design
from sandbox.study.design.meaning.findings import findings
from tests.support.study_files import SOUND

CONSENT = {
    "en": "Your touches are recorded. You may stop at any time.",
    "de": "Ihre Berührungen werden aufgezeichnet. Sie können jederzeit aufhören.",
    "fr": "Vos contacts sont enregistrés. Vous pouvez arrêter à tout moment.",
    "es": "Sus toques se registran. Puede parar en cualquier momento.",
    "it": "I Suoi tocchi vengono registrati. Può interrompere in qualsiasi momento.",
    "nl": "Uw aanrakingen worden opgenomen. U kunt op elk moment stoppen.",
    "pt": "Os seus toques são registados. Pode parar a qualquer momento.",
    "zh": "我们会记录数据，您可以随时停止。",
    "ja": "データを記録します。いつでも中止できます。",
}
"""That people may stop, and what is recorded."""
TOGETHER = (
    'name = "two"\nparticipants = 24\nlanguages = ["{code}"]\n[settings]\n'
    'task = "carry-together"\nsecond_device = "simulated"\n[[factors]]\nname = "contact"\n'
    'order = "latin"\nlevels = ["hard", "soft"]\n[trials]\npractice = 2\n'
    'practice_each = "contact"\n[consent]\ntext = "{consent} {told}"\n'
)
"""A task for two hands, of which a simulated user moves the second."""


def spoken(code: str) -> str:
    """A sound design in one language, without its questionnaire."""
    text = SOUND[: SOUND.index("[[questionnaires]]")]
    old = "Your touches are recorded. You may stop at any time. Do you agree?"
    assert old in text
    return text.replace(old, CONSENT[code]).replace("seed = 3", f'seed = 3\nlanguages = ["{code}"]')


def consenting(text: str, code: str = "en") -> str:
    """A sound design in one language, whose consent says something more."""
    told = spoken(code)
    assert CONSENT[code] in told
    return told.replace(CONSENT[code], f"{CONSENT[code]} {text}")


def one(text: str, wanted: str) -> None:
    """Asserts that a design has one finding, which says something; none if nothing is wanted."""
    read = parse_design(text, Path("design.toml"), try_out=False)
    found = [f.mistake for f in findings(read) if f.mistake.where != "languages"]
    assert len(found) == bool(wanted), found
    assert all(wanted in mistake.what and mistake.remedy for mistake in found), found
