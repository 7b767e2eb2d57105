"""Words that several kinds of flaws have to do with, by language."""

from __future__ import annotations

from sandbox.study.design.told.texts import Phrases

DENIES = Phrases(
    {
        "en": r"(not|never|without|no|nobody|neither|nor|apart|separate\w*|\w+n't)\b",
        "de": r"(nicht|nie|niemals|ohne|kein\w*|niemand\w*|weder|getrennt)\b",
        "fr": r"(pas|jamais|sans|aucun\w*|ni|separe\w*)\b",
        "es": r"(no|nunca|sin|ningun\w*|ni|tampoco|separad\w*)\b",
        "it": r"(non|mai|senza|nessun\w*|ne)\b",
        "nl": r"(niet|nooit|zonder|geen|apart)\b",
        "pt": r"(nao|nunca|sem|nenhum\w*|nem)\b",
        "zh": r"不|没|无",
        "ja": r"ない|ません|なし",
    }
)
"""Words of sentences that say that something is not so."""
PAID = Phrases(
    {
        "en": (
            r"bonus\w*|reward\w*|prizes?|earn\w*|wins?|cents?|pence|euros?|dollars?|pounds|"
            r"vouchers?|paid|payments?|pays?|credits?|lottery|raffle"
        ),
        "de": (
            r"bonus|pramie\w*|belohn\w*|gewinn\w*|preise?|verdien\w*|cent|euro|gutschein\w*|"
            r"vergut\w*|bezahl\w*|verlos\w*|zulage"
        ),
        "fr": (
            r"bonus|primes?|recompens\w*|gagn\w*|centimes?|euros?|bons? d'achat|remuner\w*|pay(e|"
            r"ee|es|ees|ons)?\b|tombola"
        ),
        "es": (
            r"bonos?|bonus|primas?|premi\w*|recompens\w*|gan(a|ara|aras|an)\b|centimos?|euros?|"
            r"vales?\b|pag(o|a|amos|aran|ado|ada)s?\b|remuner\w*|sorteo|cobr\w*"
        ),
        "it": (
            r"bonus|premi\w*|ricompens\w*|guadagn\w*|vinc\w*|centesim\w*|euro|buon[oi] |pag(a|ato|"
            r"amento)|compenso"
        ),
        "nl": (
            r"bonus|belon\w*|premie|win(t|nen)\b|verdien\w*|cent|euro|bon\b|cadeaubon|betaal\w*|"
            r"vergoed\w*"
        ),
        "pt": (
            r"bonus|premi\w*|recompens\w*|ganh\w*|centimos?|euros?|vales?\b|pag(o|a|amento)|"
            r"remuner\w*"
        ),
        "zh": r"奖金|奖励|奖品|报酬|\d元",
        "ja": r"ボーナス|報酬|賞|\d円|謝礼",
        "ar": r"مكافأ|جائز|يورو|دولار|ريال",
    }
)
"""Pay, of which every level is to promise the same."""
LEADER = Phrases(
    {
        "en": r"experimenter|researcher|investigator|assistant|supervisor|staff",
        "de": r"versuchsleit\w*|untersuch\w*|forsch\w*|studienleit\w*|assistent\w*",
        "fr": r"experimentat\w*|chercheu\w*|responsable|assistant\w*",
        "es": r"investigador\w*|experimentador\w*|responsable|asistente",
        "it": r"sperimentat\w*|ricercat\w*|responsabile|assistente",
        "nl": r"onderzoek\w*|proefleid\w*|begeleid\w*",
        "pt": r"investigador\w*|pesquisador\w*|responsavel|assistente",
    }
)
"""Those who run a study, who may wait next door."""
PRACTICE = Phrases(
    {
        "en": r"practi[cs]\w*|breaks?\b|questions?|read\b",
        "de": r"\w*ubung\w*|ube\w*|pause\w*|frage\w*|les\w*",
        "fr": r"entrain\w*|pauses?|questions?|lire|lisez",
        "es": r"practic\w*|pausas?|preguntas?|lea|leer",
        "it": r"pratic\w*|paus[ae]|domand\w*|legg\w*",
        "nl": r"oefen\w*|pauze\w*|vra(ag|gen)|lees|lezen",
        "zh": r"练习|休息|阅读|问题",
        "ja": r"練習|休|読|質問",
    }
)
"""Texts about other things than trials that count."""
