"""Flaws of the consent: it is forced, or does not say what people agree to."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import START, Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import CONSENT, Phrases, quoted, sentences, told_texts

PLACE = ("consent", "text")

FORCED = Phrases(
    {
        "en": (
            r"(?<!nobody )(?<!no one )(?<!no-one )(is|are|be|am) (strictly )?(required|obliged|"
            r"obligated|compelled|forced) to (take part|participate|attend|complete|finish|stay|"
            r"continue)|(participation|taking part|attendance) (in [\w ]+ )?is (mandatory|"
            r"compulsory|required|obligatory|not voluntary|not optional)|(mandatory|"
            r"compulsory) (participation|part of)|withdraw\w*[^.,;]* (is|are) (not (possible|"
            r"allowed|permitted)|impossible|excluded)|(?<!not )(?<!n't )(must|have to|"
            r"need to) (take part|participate|(complete|finish|do) (all|every|the whole|"
            r"the entire))|(you|participants?|students?|nobody|no one|who\w*)[^.,;]* (must not|"
            r"may not|cannot|can ?not|can't|can no longer|are not (allowed|permitted|free|"
            r"able) to|is (not )?allowed to) (stop|quit|leave|withdraw|drop out|break off|"
            r"change your mind|end)|(no|without (a|any|the)) (right|possibility|way) (to|"
            r"of) (stop|quit|leav|withdraw)|(consent|agreement) (cannot|can ?not|"
            r"can't) be (withdrawn|revoked)|(?<!not )(?<!nobody )"
            r"(?<!no one )(?<!without )(fails?|failing|failed) "
            r"(the|this|that|your|a) (course|class|exercise|module|exam|seminar|assignment)|"
            r"(participation|taking part|attendance) (in [\w ]+ )?is (a |an )?(condition|"
            r"precondition|prerequisite|requirement|duty)|(treatment|therapy|care|grade|mark|job|"
            r"contract|promotion|place)\b[^.;]*\b(?<!not )depends? on (your )?(participation|"
            r"taking "
            r"part|whether you|this study)"
        ),
        "de": (
            r"(teilnahme|mitmachen|anwesenheit) ist ((?!nicht|kein)\w+ ){0,4}(verpflichtend|"
            r"pflicht|obligatorisch|vorgeschrieben|nicht freiwillig)|(?<!niemand )(sind|bist|ist|"
            r"seid) (sie |du |ihr )?(?!nicht|keines)(\w+ )?verpflichtet|(mussen|musst|"
            r"muss) ((?!nicht|kein)\w+ )?(teilnehmen|(alle|samtliche|jeden) [^.,;]*(abschliessen|"
            r"beenden|machen|absolvieren|erledigen)|bis zum (ende|schluss))|(durfen|konnen|darf|"
            r"kann|kannst|darfst)[^.,;]* nicht (mehr )?(\w+ ){0,2}(aufhoren|abbrechen|"
            r"zurucktreten|widerrufen|zuruckgezogen|aussteigen|gehen)|kein (recht|widerruf|"
            r"rucktritt|abbruch)|(widerruf|rucktritt|abbruch)\w* ist (nicht|aus)|"
            r"(?<!nicht )(als|gilt|gelten|haben|hat) (\w+ ){0,3}nicht bestanden|"
            r"(?<!nicht )(durchfallen|durchgefallen)|"
            r"teilnahme ist (die |eine? )?(voraussetzung|bedingung|pflicht)|(behandlung|therapie|"
            r"note|stelle|vertrag|versorgung)\b[^.;]*\b(hangt|hangen) (?!nicht)[^.;]*(teilnahme|"
            r"teilnehmen|mitmachen)"
        ),
        "fr": (
            r"participation (\w+ ){0,4}est obligatoire|(etes|es|est) ((?!pas)\w+ )?(tenue?s?|"
            r"obligee?s?) d[e']|(vous|tu) ne (pouvez|pourrez|devez|peux|pourras) (pas|"
            r"plus) (\w+ )?(arreter|interrompre|vous retirer|te retirer|quitter|abandonner)|"
            r"(devez|dois) (participer|terminer|finir)|(cours|module|examen|unite|exercice|tp|"
            r"td)[^.;]* ne (sera|seront|serez)[^.;]* valide|participation est (une |la )?"
            r"condition|(echouer|echouez) (au|a la|a l')|(traitement|therapie|note|contrat|"
            r"soins)\b[^.;]* depend\w* de (votre|ta) participation"
        ),
        "es": (
            r"participacion ((?!no\b)\w+ ){0,4}es obligatoria|(?<!no )(esta|estas|"
            r"estan) obligad[oa]s? a|no (puede|podra|puedes|podras|pueden) (detener|parar|retirar|"
            r"abandonar|interrumpir|dejar)|(debe|debes|tiene que|tienes que) (participar|"
            r"(completar|terminar|hacer) tod[oa]s)|(?<!no )suspend(e|era|eran|en) "
            r"(la|el) (asignatura|curso|practica|examen)|no (aprobara|superara) "
            r"(la|el) (asignatura|curso|practica|examen)|"
            r"participacion es (una |un |la )?(condicion|requisito)|(tratamiento|terapia|nota|"
            r"contrato)\b[^.;]* (?<!no )depende\w* de (su|tu) participacion"
        ),
        "it": (
            r"partecipazione ((?!non)\w+ ){0,4}e obbligatoria|(?<!non )e (tenut|obbligat)[oai] a|"
            r"non (puo|puoi|potra|potrai) (interrompere|ritirar|smettere|fermar|abbandonare)|"
            r"(deve|devi) (partecipare|(completare|finire) tutt[ei])|(corso|esame|modulo)[^.;]* "
            r"non (sara|verra|viene|e) (superato|valid|approvat)\w*|"
            r"partecipazione e (una |la )?condizione"
        ),
        "nl": (
            r"deelname (\w+ ){0,4}is verplicht|(bent|ben) (u |je )?verplicht|(kunt|mag|kan|"
            r"kun)[^.,;]* niet (meer )?(\w+ )?(stoppen|ophouden|terugtrekken|weggaan)|(moet|"
            r"moeten) (meedoen|deelnemen|alle [^.,;]*(afmaken|doen))|(vak|cursus|opdracht|"
            r"tentamen)[^.;]* niet (gehaald|behaald)|deelname is (een |de )?voorwaarde"
        ),
        "pt": (
            r"participacao ((?!nao)\w+ ){0,4}e obrigatoria|(?<!nao )e obrigad[oa]s? a|nao (pode|"
            r"podera|podes) (parar|desistir|abandonar|interromper|retirar)"
        ),
        "zh": r"必须(参加|完成|参与)|不(得|能|可|可以|允许)(中途)?(退出|停止|中止)|强制参加",
        "ja": (
            r"参加は(義務|必須)|(やめる|中止する|中断する|辞退する)ことはできません|(やめ|中止|"
            r"中断)できません"
        ),
    }
)
"""Participation that is required, or that cannot be ended."""

LEAVES = Phrases(
    {
        "en": (
            r"stop|stops|stopping|leaving|quitting|quit|quits|leave early|leaves|withdraw\w*|"
            r"drop out|drops out|break off|(do|does|did) not (finish|complete|take part|"
            r"participate|agree)|declin\w+|refus\w+|not (finishing|completing|taking part)|"
            r"incomplete|only (those|people|participants|students)?[^.]*(finish|complet)|(if|"
            r"when) (you|they) (finish|complete)"
        ),
        "de": (
            r"aufhor\w*|abbrech\w*|abbrich\w*|abbruch|nicht (bis|teilnehm|zustimm|beend|"
            r"abschliess)|nur wer|zurucktret\w*|zuruckzieh\w*|ablehn\w*|vorzeitig"
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
            r"(lose|loses|forfeit\w*)|(get|receive|earn)s? (no|neither|nothing)|(not|never) (get|"
            r"receive|be (paid|compensated|rewarded|credited))|(is|are) not (paid|compensated|"
            r"rewarded|credited)|no (payment|pay|credit|credits|compensation|reward|money|voucher|"
            r"points?) |no (payment|pay|credits?|compensation|reward|money|voucher|points?)$|"
            r"fail (the|this) (course|class)|(points|marks|grade|money) (is|are|"
            r"will be) (deducted|lowered)|(is|are|will be) (fined|penali[sz]ed|reported|punished|"
            r"noted|marked)|(paid|payment|credits?|reward|voucher|compensat\w+|"
            r"money)[^.]* only [^.]*(finish|complet)|only [^.]*(finish|complet)[^.]*(paid|payment|"
            r"credits?|reward|voucher|compensat|money)|(lower|worse) (grade|mark)|(teacher|"
            r"supervisor|boss|employer|lecturer|manager|professor)[^.]*(told|informed|know)|(tell|"
            r"inform) your (teacher|supervisor|boss|employer|lecturer|manager|professor)"
        ),
        "de": (
            r"verlier\w*|(erhal|bekomm)\w+ (\w+ ){0,2}(kein\w*|nichts)|(entfallt|verfallt|"
            r"abgezogen)|kein\w* (vergutung|geld|punkt\w*|bezahlung|aufwandsentschadigung|"
            r"versuchspersonenstund\w*)|nur wer|nicht (bezahlt|vergutet|angerechnet|"
            r"gutgeschrieben)|gemeldet|bestraft|durchgefallen"
        ),
        "fr": (
            r"perd\w*|(aucune?|pas de|sans) (remuneration|paiement|credit|point)|signal|penali|"
            r"sanction"
        ),
        "es": r"perder\w*|pierd\w*|no (recib|cobr)\w*|sin (pago|creditos?|remuneracion)|penaliz\w*",
        "it": r"perd\w*|non ricev\w*|nessun (compenso|credito|pagamento)|penalizzat\w*",
        "nl": r"verlie\w*|geen (vergoeding|punten|geld|betaling)|bestraft|gemeld",
    }
)
SPARED = Phrases(
    {
        "en": (
            r"(not|never|nor|without|no) (\w+ ){0,3}(los|forfeit|penal|disadvantage|consequence|"
            r"told|tell|inform|report|noted|affect|influence|lower)|(still|anyway|nevertheless|"
            r"nonetheless|regardless|even if|whether or not|any\w* disadvantage)"
        ),
        "de": (
            r"(ohne|nicht|keine\w*) (\w+ ){0,3}(verlier|verlust|nachteil|konsequenz|folgen)|"
            r"trotzdem|dennoch|auch wenn|jedenfalls|auch (dann|in diesem fall)"
        ),
        "fr": (
            r"(sans|ne|aucun\w*) (\w+ ){0,3}(perd|consequence|penalite|prejudice|sanction)|"
            r"quand meme|meme si"
        ),
        "es": (
            r"(sin|no|ningun\w*) (\w+ ){0,3}(perder|pierd|consecuencia|penaliza|perjuicio)|"
            r"igualmente|aunque|de todos modos"
        ),
        "it": (
            r"(senza|non|nessun\w*) (\w+ ){0,3}(perd|conseguenz|penal|svantagg)|comunque|anche se"
        ),
        "nl": r"(zonder|niet|geen) (\w+ ){0,3}(verlie|gevolg|nadel)|toch|ook als",
    }
)
KEPT = Phrases(
    {
        "en": (
            r"(data|recordings?|answers|everything|results|information|records?|it|they|"
            r"that)\b[^.;]*(cannot|can ?not|can't|can no longer|could not|will not|won't|"
            r"will never|may not|must not|never) be (deleted|removed|erased|withdrawn|destroyed|"
            r"taken back)|no (right|possibility|way) (to|of) (\w+ ){0,4}(delet|eras|remov)"
        ),
        "de": (
            r"(daten|aufzeichnungen|antworten|ergebnisse|was|alles)[^.;]*(nicht|nie) (mehr |"
            r"wieder )?(geloscht|entfernt|vernichtet|zuruckgezogen)|(kein|"
            r"keine) (recht auf )?loschung"
        ),
        "fr": (
            r"(donnees|enregistrements|reponses)[^.;]*ne (peuvent|pourront|seront|sont) (pas|plus|"
            r"jamais) (etre )?(effac|supprim|detrui|retir)"
        ),
        "es": (
            r"(datos|grabaciones|respuestas)[^.;]*no (se )?(podran|pueden|podra|puede|"
            r"seran)[^.;]* ?(borra|elimina|suprimi|retira)"
        ),
        "it": (
            r"(dati|registrazioni|risposte)[^.;]*non (possono|potranno|saranno)[^.;]*(cancellat|"
            r"eliminat|ritirat)"
        ),
        "nl": (
            r"(gegevens|opnamen|antwoorden|data)[^.;]*niet (meer )?(\w+ )?(verwijder|gewist|gewis|"
            r"vernietig|ingetrokken)"
        ),
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

NAMED = Phrases(
    {
        "en": (
            r"(with|under|next to|beside|alongside) your (full |real |own |first |last )?names?\b"
        ),
        "de": r"(unter|mit|neben|bei) (ihrem|deinem) (vollen |echten |eigenen )?namen\b",
        "fr": r"(sous|avec|a cote de) (votre|ton) (vrai |propre )?nom\b",
        "es": r"(con|bajo|junto a) (su|tu) (propio )?nombre\b",
        "it": r"(con|sotto|accanto a)l? (il )?(suo|tuo) nome\b",
        "nl": r"(met|onder|naast) (uw|je) (eigen |volledige )?naam\b",
        "pt": r"(com|sob) (o )?(seu|teu) nome\b",
        "zh": r"(与|和|连同)(您|你)的(姓名|名字)",
        "ja": r"(お名前|氏名)(と|とともに|と一緒に)(記録|保存|公開)",
    }
)
"""Data beside the name of the person."""
PASSED_ON = Phrases(
    {
        "en": (
            r"(results?|scores?|times|performance|data|answers|recordings|how (well|"
            r"fast))\b[^.;]*\b"
            r"(shown|given|passed|sent|reported|available|told|forwarded|communicated|visible|"
            r"disclosed) (on )?to (your|the) (\w+ )?(employer|teacher|lecturer|professor|"
            r"supervisor|"
            r"manager|boss|insur\w+|doctor|trainer|coach|company|school|team leader)|(employer|"
            r"teacher|"
            r"lecturer|professor|supervisor|manager|boss|insur\w+|trainer|coach|company|school)\b"
            r"[^.;]*\b(gets|receives|sees|will (get|receive|see)) (your |the |all )?(\w+ "
            r")?(results?|"
            r"scores?|times|data|answers|recordings)"
        ),
        "de": (
            r"(ergebnis|leistung|daten|zeiten|antworten|aufzeichnung)\w*\b[^.;]*\b(arbeitgeber|"
            r"lehr(er|kraft)|lehrerin|dozent|professor|vorgesetzt|chef|versicherung|krankenkasse|"
            r"trainer|schule|firma|betrieb)\w*[^.;]*(gezeigt|weitergegeben|weitergeleitet|"
            r"mitgeteilt|"
            r"ubermittelt|gemeldet|vorgelegt|zugesandt)|(arbeitgeber|lehrer|lehrkraft|dozent|"
            r"vorgesetzt|chef|versicherung|krankenkasse|trainer)\w*[^.;]*(erhalt|bekommt|sieht|"
            r"erfahrt)[^.;]*(ergebnis|leistung|daten|zeiten|antworten)"
        ),
        "fr": (
            r"(resultats?|performances?|donnees|temps|reponses)\b[^.;]*(transmis|communiqu|montr|"
            r"envoy|remis)\w* (a|au) (votre |l'|la |le )?(employeur|professeur|enseignant|"
            r"superieur|"
            r"assur|medecin|chef|entraineur|ecole|entreprise)\w*"
        ),
        "es": (
            r"(resultados?|datos|tiempos|respuestas|rendimiento)\b[^.;]*(mostr|envi|entreg|comunic|"
            r"inform|transmit)\w* (a|al) (su |la |tu )?(jef[ea]|profesor|empleador|empresa|"
            r"aseguradora|medic|superior|entrenador|escuela)\w*"
        ),
    }
)
"""Data of a person that go to people who have power over them."""
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

FREE = Phrases(
    {
        "en": (
            r"not (required|obliged|mandatory)|stop|stops|withdraw\w*|quit|leave|leaving|"
            r"voluntar\w*|break off|drop out|discontinu\w*|interrupt|free to|freely|any ?time|"
            r"any (moment|point|stage)|whenever|end (the|your|this)|sheet|leaflet|information|"
            r"paper|document|letter|brochure"
        ),
        "de": (
            r"nicht verpflicht\w*|aufhor\w*|abbrech\w*|abbruch|beenden|zuruckzieh\w*|"
            r"zurucktret\w*|widerruf\w*|freiwillig\w*|jederzeit|unterbrech\w*|aussteig\w*|"
            r"\w*blatt|\w*schreiben|unterlagen|aufklarung\w*|\w*information\w*"
        ),
        "fr": (
            r"arret\w*|interromp\w*|retir\w*|quitt\w*|volont\w*|benevol\w*|tout moment|librement|"
            r"libre|abandon\w*|notice|feuille|lettre|document|information\w*"
        ),
        "es": (
            r"parar|deten\w*|retir\w*|abandon\w*|interrump\w*|volunt\w*|cualquier momento|"
            r"libre\w*|dejar\w*|hoja|carta|documento|informacion"
        ),
        "it": (
            r"interromp\w*|ritir\w*|smett\w*|abbandon\w*|volontari\w*|qualsiasi momento|"
            r"ogni momento|liber\w*|foglio|lettera|documento|informa\w*|ferma\w*"
        ),
        "nl": (
            r"stop\w*|ophoud\w*|terugtrek\w*|vrijwillig\w*|elk moment|altijd|vrij|afbrek\w*|brief|"
            r"folder|informatie\w*"
        ),
        "zh": r"停止|退出|自愿|随时|中止|说明书|知情",
        "ja": r"中止|やめ|辞退|自由|任意|いつでも|中断|撤回|説明(書|文書)",
        "ar": r"التوقف|تتوقف|الانسحاب|تنسحب|طوع|في أي",
    }
)
"""That people may stop, or another document that says so."""

RECORDED = Phrases(
    {
        "en": (
            r"record|data|measur|stor(e|ing)|saved?|log|collect|ke(ep|pt)|track|sheet|leaflet|"
            r"information|paper|document|letter|brochure"
        ),
        "de": (
            r"aufzeich|aufgezeich|\w*daten|gespeich|speicher|erfass|erhoben|erheb|mess|gemess|"
            r"protokoll|\w*blatt|\w*schreiben|unterlagen|aufklarung|\w*information"
        ),
        "fr": r"enregistr|donnees|mesur|recueil|conserv|collect|notice|feuille|lettre|information",
        "es": r"registr|grab|datos|guard|recog|medi|hoja|carta|documento|informacion",
        "it": r"registr|dati|misur|salv|raccog|raccol|conserv|foglio|lettera|documento|informa",
        "nl": (
            r"opgenomen|opnemen|gegevens|data|bewa|vastgelegd|met(en|ing)|gemeten|brief|folder|"
            r"informatie"
        ),
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
        bare = next((s for s in sentences(text) if _exposes(s, language)), None)
        if bare is not None:
            yield Flaw(
                PLACE,
                f"consent{where} exposes people where it says {quoted(bare)}",
                "Keep data under a pseudonym, and give nobody else the data of one person",
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


def _exposes(sentence: str, language: str) -> bool:
    """True if data are kept beside a name, or given to people who have power over somebody."""
    if DENIES.match(sentence, language):
        return False
    named = NAMED.match(sentence, language) and RECORDED.match(sentence, language)
    return bool(named) or PASSED_ON.match(sentence, language) is not None


def _forces(sentence: str, language: str) -> bool:
    """True if a sentence rules out to stop, punishes it, or rules out that data are deleted."""
    bound = FORCED.match(sentence, language) or KEPT.match(sentence, language)
    if bound and not NAMELESS.match(sentence, language):
        return True
    leaves = LEAVES.match(sentence, language) and PUNISHED.match(sentence, language)
    return bool(leaves) and not SPARED.match(sentence, language)
