"""Flaws of the consent: it is forced, or does not say what people agree to."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import START, Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.meaning.texts import CONSENT, Phrases, quoted, sentences, told_texts

PLACE = ("consent", "text")

FORCED = Phrases(
    {
        "en": (
            r"(is|are|be|am) (strictly )?(required|obliged|obligated|compelled|forced) to (take "
            r"part|"
            r"participate|attend|complete|finish|stay|continue)|"
            r"(participation|taking part|attendance) (in [\w ]+ )?is (mandatory|compulsory|"
            r"required|"
            r"obligatory|not voluntary|not optional)|(mandatory|compulsory) (participation|part "
            r"of)|"
            r"withdraw\w*[^.,;]* (is|are) (not (possible|allowed|permitted)|impossible|excluded)|"
            r"(?<!not )(?<!n't )(must|have to|need to) (take part|participate|(complete|finish|"
            r"do) (all|every|the whole|"
            r"the entire))|"
            r"(you|participants?|students?|nobody|no one|who\w*)[^.,;]* (must not|may not|cannot|"
            r"can ?not|can't|can no longer|are not (allowed|permitted|free|able) to|"
            r"is (not )?allowed to) (stop|quit|leave|withdraw|drop out|break off|"
            r"change your mind|end)|(no|without (a|any|the)) (right|possibility|way) (to|of) "
            r"(stop|quit|leav|withdraw)|(consent|agreement) (cannot|can ?not|can't) be (withdrawn|"
            r"revoked)"
        ),
        "de": (
            r"(teilnahme|mitmachen|anwesenheit) ist (\w+ ){0,4}(verpflichtend|pflicht|"
            r"obligatorisch|"
            r"vorgeschrieben|nicht freiwillig)|(sind|bist|ist|seid) (sie |du |ihr )?"
            r"(?!nicht|keines)(\w+ )?verpflichtet|(mussen|musst|muss) (\w+ )?(teilnehmen|(alle|"
            r"samtliche|jeden) [^.,;]*"
            r"(abschliessen|beenden|machen|absolvieren|erledigen)|bis zum (ende|schluss))|"
            r"(durfen|konnen|darf|kann|kannst|darfst)[^.,;]* nicht (mehr )?(\w+ ){0,2}(aufhoren|"
            r"abbrechen|"
            r"zurucktreten|widerrufen|zuruckgezogen|aussteigen|gehen)|"
            r"kein (recht|widerruf|rucktritt|abbruch)|(widerruf|rucktritt|abbruch)\w* ist "
            r"(nicht|aus)"
        ),
        "fr": (
            r"participation (\w+ ){0,4}est obligatoire|(etes|es|est) (\w+ )?(tenue?s?|obligee?s?) "
            r"d[e']|"
            r"(vous|tu) ne (pouvez|pourrez|devez|peux|pourras) (pas|plus) (\w+ )?(arreter|"
            r"interrompre|"
            r"vous retirer|te retirer|quitter|abandonner)|(devez|dois) (participer|terminer|finir)"
        ),
        "es": (
            r"participacion (\w+ ){0,4}es obligatoria|(esta|estas|estan) obligad[oa]s? a|"
            r"no (puede|podra|puedes|podras|pueden) (detener|parar|retirar|abandonar|interrumpir|"
            r"dejar)|"
            r"(debe|debes|tiene que|tienes que) (participar|(completar|terminar|hacer) tod[oa]s)"
        ),
        "it": (
            r"partecipazione (\w+ ){0,4}e obbligatoria|e (tenut|obbligat)[oai] a|"
            r"non (puo|puoi|potra|potrai) (interrompere|ritirar|smettere|fermar|abbandonare)|"
            r"(deve|devi) (partecipare|(completare|finire) tutt[ei])"
        ),
        "nl": (
            r"deelname (\w+ ){0,4}is verplicht|(bent|ben) (u |je )?verplicht|"
            r"(kunt|mag|kan|kun)[^.,;]* niet (meer )?(\w+ )?(stoppen|ophouden|terugtrekken|"
            r"weggaan)|"
            r"(moet|moeten) (meedoen|deelnemen|alle [^.,;]*(afmaken|doen))"
        ),
        "pt": (
            r"participacao (\w+ ){0,4}e obrigatoria|e obrigad[oa]s? a|"
            r"nao (pode|podera|podes) (parar|desistir|abandonar|interromper|retirar)"
        ),
        "zh": r"必须(参加|完成|参与)|不(得|能|可|可以|允许)(中途)?(退出|停止|中止)|强制参加",
        "ja": r"参加は(義務|必須)|(やめる|中止する|中断する|"
        r"辞退する)ことはできません|(やめ|中止|中断)できません",
    }
)
"""Participation that is required, or that cannot be ended."""

LEAVES = Phrases(
    {
        "en": (
            r"stop|stops|stopping|leaving|quitting|quit|quits|leave early|leaves|withdraw\w*|drop "
            r"out|drops out|break off|"
            r"(do|does|did) not (finish|complete|take part|participate|agree)|declin\w+|refus\w+|"
            r"not (finishing|completing|taking part)|incomplete|only (those|people|participants|"
            r"students)?[^.]*(finish|complet)|(if|when) (you|they) (finish|complete)"
        ),
        "de": (
            r"aufhor\w*|abbrech\w*|abbrich\w*|abbruch|nicht (bis|teilnehm|zustimm|beend|"
            r"abschliess)|"
            r"nur wer|zurucktret\w*|zuruckzieh\w*|ablehn\w*|vorzeitig"
        ),
        "fr": r"arret\w*|interromp\w*|retir\w*|abandon\w*|refus\w*|quitt\w*",
        "es": r"parar?|pare|deten\w*|detien\w*|retir\w*|abandon\w*|interrump\w*|rechaz\w*|deje",
        "it": r"interromp\w*|ritir\w*|smett\w*|abbandon\w*|rifiut\w*",
        "nl": r"stopt?|stoppen|ophoud\w*|terugtrek\w*|weiger\w*|afbreek\w*|afbrek\w*",
    }
)
PUNISHED = Phrases(
    {
        "en": (
            r"(lose|loses|forfeit\w*)|(get|receive|earn)s? (no|neither|nothing)|"
            r"(not|never) (get|receive|be (paid|compensated|rewarded|credited))|"
            r"(is|are) not (paid|compensated|rewarded|credited)|no (payment|pay|credit|credits|"
            r"compensation|reward|money|voucher|points?) |no (payment|pay|credits?|compensation|"
            r"reward|"
            r"money|voucher|points?)$|fail (the|this) (course|class)|"
            r"(points|marks|grade|money) (is|are|will be) (deducted|lowered)|"
            r"(is|are|will be) (fined|penali[sz]ed|reported|punished|noted|marked)|"
            r"(paid|payment|credits?|reward|voucher|compensat\w+|money)[^.]* only [^.]*(finish|"
            r"complet)|"
            r"only [^.]*(finish|complet)[^.]*(paid|payment|credits?|reward|voucher|compensat|"
            r"money)|"
            r"(lower|worse) (grade|mark)|(teacher|supervisor|boss|employer|lecturer|manager|"
            r"professor)"
            r"[^.]*(told|informed|know)|(tell|inform) your (teacher|supervisor|boss|employer|"
            r"lecturer|"
            r"manager|professor)"
        ),
        "de": (
            r"verlier\w*|(erhal|bekomm)\w+ (\w+ ){0,2}(kein\w*|nichts)|(entfallt|verfallt|"
            r"abgezogen)|"
            r"kein\w* (vergutung|geld|punkt\w*|bezahlung|aufwandsentschadigung|"
            r"versuchspersonenstund\w*)|"
            r"nur wer|nicht (bezahlt|vergutet|angerechnet|gutgeschrieben)|gemeldet|bestraft|"
            r"durchgefallen"
        ),
        "fr": r"perd\w*|(aucune?|pas de|sans) (remuneration|paiement|credit|point)|signal|penali|"
        r"sanction",
        "es": r"perder\w*|pierd\w*|no (recib|cobr)\w*|sin (pago|creditos?|remuneracion)|penaliz\w*",
        "it": r"perd\w*|non ricev\w*|nessun (compenso|credito|pagamento)|penalizzat\w*",
        "nl": r"verlie\w*|geen (vergoeding|punten|geld|betaling)|bestraft|gemeld",
    }
)
SPARED = Phrases(
    {
        "en": r"(not|never|nor|without|no) (\w+ ){0,3}(los|forfeit|penal|disadvantage|"
        r"consequence|told|tell|inform|report|noted|affect|influence|lower)|"
        r"(still|anyway|nevertheless|nonetheless|regardless|even if|whether or not|any\w* "
        r"disadvantage)",
        "de": r"(ohne|nicht|keine\w*) (\w+ ){0,3}(verlier|verlust|nachteil|konsequenz|folgen)|"
        r"trotzdem|"
        r"dennoch|auch wenn|jedenfalls|auch (dann|in diesem fall)",
        "fr": r"(sans|ne|aucun\w*) (\w+ ){0,3}(perd|consequence|penalite|prejudice|sanction)|"
        r"quand meme|"
        r"meme si",
        "es": r"(sin|no|ningun\w*) (\w+ ){0,3}(perder|pierd|consecuencia|penaliza|perjuicio)|"
        r"igualmente|aunque|de todos modos",
        "it": r"(senza|non|nessun\w*) (\w+ ){0,3}(perd|conseguenz|penal|svantagg)|comunque|anche "
        r"se",
        "nl": r"(zonder|niet|geen) (\w+ ){0,3}(verlie|gevolg|nadel)|toch|ook als",
    }
)
KEPT = Phrases(
    {
        "en": r"(data|recordings?|answers|everything|results|information|records?|it|they|"
        r"that)\b[^.;]*"
        r"(cannot|can ?not|can't|can no longer|could not|will not|won't|will never|may not|must "
        r"not|"
        r"never) be "
        r"(deleted|removed|erased|withdrawn|destroyed|taken back)|no (right|possibility|way) (to|"
        r"of) "
        r"(\w+ ){0,4}(delet|eras|remov)",
        "de": r"(daten|aufzeichnungen|antworten|ergebnisse|was|alles)[^.;]*(nicht|nie) (mehr |"
        r"wieder )?"
        r"(geloscht|entfernt|vernichtet|zuruckgezogen)|(kein|keine) (recht auf )?loschung",
        "fr": r"(donnees|enregistrements|reponses)[^.;]*ne (peuvent|pourront|seront|sont) (pas|"
        r"plus|"
        r"jamais) (etre )?(effac|supprim|detrui|retir)",
        "es": r"(datos|grabaciones|respuestas)[^.;]*no (se )?(podran|pueden|podra|puede|"
        r"seran)[^.;]* "
        r"?(borra|elimina|suprimi|retira)",
        "it": r"(dati|registrazioni|risposte)[^.;]*non (possono|potranno|saranno)[^.;]*(cancellat|"
        r"eliminat|ritirat)",
        "nl": r"(gegevens|opnamen|antwoorden|data)[^.;]*niet (meer )?(\w+ )?(verwijder|gewist|"
        r"gewis|"
        r"vernietig|ingetrokken)",
        "zh": r"(数据|记录)[^。]*(不能|无法|不会|不可)(被)?删除",
        "ja": r"(データ|記録)[^。]*(削除できません|削除することはできません|消去できません)",
    }
)
"""Data that are never deleted."""
NAMELESS = Phrases(
    {
        "en": r"anonym\w*|publish\w*|publication|cannot be (linked|assigned|traced)|no longer know",
        "de": r"anonym\w*|veroffentlich\w*|nicht mehr zugeordnet",
        "fr": r"anonym\w*|publi\w*",
        "es": r"anoni\w*|public\w*",
        "it": r"anoni\w*|pubblic\w*",
        "nl": r"anoni\w*|publi\w*|gepubliceerd",
        "zh": r"匿名|发表",
        "ja": r"匿名|公表|発表",
    }
)
"""Reasons why data can no longer be deleted: nobody knows any more whose they are."""

FREE = Phrases(
    {
        "en": r"stop|stops|withdraw\w*|quit|leave|leaving|voluntar\w*|break off|drop out|"
        r"discontinu\w*|interrupt|free to|freely|any ?time|any (moment|point|stage)|whenever|"
        r"end (the|your|this)|sheet|leaflet|information|paper|document|letter|brochure",
        "de": r"aufhor\w*|abbrech\w*|abbruch|beenden|zuruckzieh\w*|zurucktret\w*|widerruf\w*|"
        r"freiwillig\w*|jederzeit|unterbrech\w*|aussteig\w*|\w*blatt|\w*schreiben|unterlagen|"
        r"aufklarung\w*|\w*information\w*",
        "fr": r"arret\w*|interromp\w*|retir\w*|quitt\w*|volont\w*|benevol\w*|tout moment|librement|"
        r"libre|abandon\w*|notice|feuille|lettre|document|information\w*",
        "es": r"parar|deten\w*|retir\w*|abandon\w*|interrump\w*|volunt\w*|cualquier momento|"
        r"libre\w*|dejar\w*|hoja|carta|documento|informacion",
        "it": r"interromp\w*|ritir\w*|smett\w*|abbandon\w*|volontari\w*|qualsiasi momento|"
        r"ogni momento|liber\w*|foglio|lettera|documento|informa\w*|ferma\w*",
        "nl": r"stop\w*|ophoud\w*|terugtrek\w*|vrijwillig\w*|elk moment|altijd|vrij|afbrek\w*|"
        r"brief|folder|informatie\w*",
        "zh": r"停止|退出|自愿|随时|中止|说明书|知情",
        "ja": r"中止|やめ|辞退|自由|任意|いつでも|中断|撤回|説明(書|文書)",
        "ar": r"التوقف|تتوقف|الانسحاب|تنسحب|طوع|في أي",
    }
)
"""That people may stop, or another document that says so."""

RECORDED = Phrases(
    {
        "en": r"record|data|measur|stor(e|ing)|saved?|log|collect|ke(ep|pt)|track|sheet|leaflet|"
        r"information|paper|document|letter|brochure",
        "de": r"aufzeich|aufgezeich|\w*daten|gespeich|speicher|erfass|erhoben|erheb|mess|gemess|"
        r"protokoll|\w*blatt|\w*schreiben|unterlagen|aufklarung|\w*information",
        "fr": r"enregistr|donnees|mesur|recueil|conserv|collect|notice|feuille|lettre|information",
        "es": r"registr|grab|datos|guard|recog|medi|hoja|carta|documento|informacion",
        "it": r"registr|dati|misur|salv|raccog|raccol|conserv|foglio|lettera|documento|informa",
        "nl": r"opgenomen|opnemen|gegevens|data|bewa|vastgelegd|met(en|ing)|gemeten|brief|folder|"
        r"informatie",
        "zh": r"记录|数据|收集|保存|采集|说明书|知情",
        "ja": r"記録|データ|保存|収集|測定|説明(書|文書)",
        "ar": r"بيانات|تسج|نسج|يسج",
    }
)
"""What is recorded, or another document that says so."""


def consent_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the consent form, one line for each."""
    for language, text in design.consent.items():
        forced = next((s for s in sentences(text) if _forces(s, language)), None)
        where = f" in {language}" if len(design.languages) > 1 else ""
        if forced is not None:
            yield Flaw(
                PLACE,
                f"consent{where} is not given freely where it says {quoted(forced)}",
                "Let everybody stop at any time without a disadvantage, and have data deleted",
            )
            continue
        texts = [t.text[language] for t in told_texts(design) if t.kind == CONSENT or t.at == START]
        unsaid = [
            what
            for what, phrases in (("that people may stop", FREE), ("what is recorded", RECORDED))
            if phrases.knows(language) and not any(phrases.match(t, language) for t in texts)
        ]
        if unsaid:
            yield Flaw(
                PLACE,
                f"consent{where} does not say {' and '.join(unsaid)}",
                "Write that touches, times and answers are recorded, and that everybody may stop "
                "at "
                "any time, without a reason or a disadvantage",
            )


def _forces(sentence: str, language: str) -> bool:
    """True if a sentence rules out to stop, punishes it, or rules out that data are deleted."""
    bound = FORCED.match(sentence, language) or KEPT.match(sentence, language)
    if bound and not NAMELESS.match(sentence, language):
        return True
    leaves = LEAVES.match(sentence, language) and PUNISHED.match(sentence, language)
    return bool(leaves) and not SPARED.match(sentence, language)
