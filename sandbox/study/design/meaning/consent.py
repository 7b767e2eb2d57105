"""Flaws of the consent: it is forced, or does not say what people agree to."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import START, Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import CONSENT, Phrases, quoted, sentences, told_texts
from sandbox.study.design.told.words import DENIES

PLACE = ("consent", "text")

FORCED = Phrases(
    {
        "en": (
            r"(?<!nobody )(?<!no one )(?<!no-one )(is|are|be|am) (strictly )?(required|obliged|"
            r"obligated|compelled|forced) to (take part|participate|attend|complete|finish|stay|"
            r"continue)|(participation|taking part|attendance) (in [\w ]+ )?is (mandatory|"
            r"compulsory|required|obligatory|not voluntary|not optional)|(mandatory|compulsory) "
            r"(participation|part of)|withdraw\w*[^.,;]* (is|are) (not (possible|allowed|"
            r"permitted)|impossible|excluded)|(?<!not )(?<!n't )(must|have to|need to) (take part|"
            r"participate|(complete|finish|do) (all|every|the whole|the entire))|(you|"
            r"participants?|students?|nobody|no one|who\w*)[^.,;]* (must not|may not|cannot|can "
            r"?not|can't|can no longer|are not (allowed|permitted|free|able) to|is (not )?allowed "
            r"to) (stop|quit|leave|withdraw|drop out|break off|change your mind|end)|(no|without "
            r"(a|any|the)) (right|possibility|way) (to|of) (stop|quit|leav|withdraw)|(consent|"
            r"agreement) (cannot|can ?not|can't) be (withdrawn|revoked)|(?<!not )(?<!nobody "
            r")(?<!no one )(?<!without )(fails?|failing|failed) (the|this|that|your|a) (course|"
            r"class|exercise|module|exam|seminar|assignment)|(participation|taking part|"
            r"attendance) (in [\w ]+ )?is (a |an )?(condition|precondition|prerequisite|"
            r"requirement|duty)|(treatment|therapy|care|grade|mark|job|contract|promotion|"
            r"place)\b[^.;]*\b(?<!not )depends? on (your )?(participation|taking part|whether you|"
            r"this study)|(?<!not )(?<!n't )(?<!nobody )(?<!no one )(?<!never )(has|have) to "
            r"(complete|finish|take part|participate|attend)\b[^.;]* (to|in order to) (pass|"
            r"graduate)\b|(who|if you|those that)[^.;]*(declin|refus|leav|stop|quit|withdraw|"
            r"drop)\w*[^.;]* (?<!not )(?<!n't )(?<!we )(?<!never )(have to|has to|must) (repeat|"
            r"retake|redo|pay)\b"
        ),
        "de": (
            r"(teilnahme|mitmachen|anwesenheit) ist ((?!nicht|kein)\w+ ){0,4}(verpflichtend|"
            r"pflicht|obligatorisch|vorgeschrieben|nicht freiwillig)|(?<!niemand )(sind|bist|ist|"
            r"seid) (sie |du |ihr )?(?!nicht|keines)(\w+ )?verpflichtet|(mussen|musst|muss) "
            r"((?!nicht|kein)\w+ )?(teilnehmen|(alle|samtliche|jeden) [^.,;]*(abschliessen|beenden|"
            r"machen|absolvieren|erledigen)|bis zum (ende|schluss))|(durfen|konnen|darf|kann|"
            r"kannst|darfst)[^.,;]* nicht (mehr )?(\w+ ){0,2}(aufhoren|abbrechen|zurucktreten|"
            r"widerrufen|zuruckgezogen|aussteigen|gehen)|kein (recht|widerruf|rucktritt|abbruch)|"
            r"(widerruf|rucktritt|abbruch)\w* ist (nicht|aus)|(?<!nicht )(als|gilt|gelten|haben|"
            r"hat) (\w+ ){0,3}nicht bestanden|(?<!nicht )(durchfallen|durchgefallen)|teilnahme ist "
            r"(die |eine? )?(voraussetzung|bedingung|pflicht)|(behandlung|therapie|note|stelle|"
            r"vertrag|versorgung)\b[^.;]*\b(hangt|hangen) (?!nicht)[^.;]*(teilnahme|teilnehmen|"
            r"mitmachen)|wer[^.;]*(ablehn|abbrich|aufhor|geht|aussteig)\w*[^.;]* muss\b"
            r"(?![^.;]*\b(nicht|kein))[^.;]*(wiederhol|nachhol|zahl)\w*"
        ),
        "fr": (
            r"participation (\w+ ){0,4}est obligatoire|(etes|es|est) ((?!pas)\w+ )?(tenue?s?|"
            r"obligee?s?) d[e']|(vous|tu) ne (pouvez|pourrez|devez|peux|pourras) (pas|plus) (\w+ "
            r")?(arreter|interrompre|vous retirer|te retirer|quitter|abandonner)|(devez|dois) "
            r"(participer|terminer|finir)|(cours|module|examen|unite|exercice|tp|td)[^.;]* ne "
            r"(sera|seront|serez)[^.;]* valide|participation est (une |la )?condition|(echouer|"
            r"echouez) (au|a la|a l')|(refus|abandonn|quitt)\w*[^.;]* (?<!ne )(devr|doi)\w* "
            r"(?!pas|rien)[^.;]*(repasser|redoubler|refaire|payer)|(traitement|therapie|note|contrat|"
            r"soins)\b[^.;]* depend\w* de (votre|ta) participation"
        ),
        "es": (
            r"participacion ((?!no\b)\w+ ){0,4}es obligatoria|(?<!no )(esta|estas|estan) "
            r"obligad[oa]s? a|no (puede|podra|puedes|podras|pueden) (detener|parar|retirar|"
            r"abandonar|interrumpir|dejar)|(debe|debes|tiene que|tienes que) (participar|"
            r"(completar|terminar|hacer) tod[oa]s)|(?<!no )suspend(e|era|eran|en) (la|el) "
            r"(asignatura|curso|practica|examen)|no (aprobara|superara) (la|el) (asignatura|curso|"
            r"practica|examen)|quien\w* [^.;]*(rechac|abandon|dej|negar|niegu)\w*[^.;]* (?<!no "
            r")(debera|deberan|tendra|tendran)[^.;]* (repetir|recuperar|pagar)|participacion "
            r"es (una |un |la )?(condicion|requisito)|(tratamiento|"
            r"terapia|nota|contrato)\b[^.;]* (?<!no )depende\w* de (su|tu) participacion"
        ),
        "it": (
            r"partecipazione ((?!non)\w+ ){0,4}e obbligatoria|(?<!non )e (tenut|obbligat)[oai] a|"
            r"non (puo|puoi|potra|potrai) (interrompere|ritirar|smettere|fermar|abbandonare)|(deve|"
            r"devi) (partecipare|(completare|finire) tutt[ei])|(corso|esame|modulo)[^.;]* non "
            r"(sara|verra|viene|e) (superato|valid|approvat)\w*|partecipazione e (una |la "
            r")?condizione"
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
            r"stop|stops|stopping|leaving|quitting|quit|quits|leave early|leaves|withdraw\w*|drop "
            r"out|drops out|break off|(do|does|did) not (finish|complete|take part|participate|"
            r"agree)|declin\w+|refus\w+|not (finishing|completing|taking part)|incomplete|only "
            r"(those|people|participants|students)?[^.]*(finish|complet)|(if|when) (you|they) "
            r"(finish|complete)"
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
            r"points?) |no (payment|pay|credits?|compensation|reward|money|voucher|points?)$|fail "
            r"(the|this) (course|class)|(points|marks|grade|money) (is|are|will be) (deducted|"
            r"lowered)|(is|are|will be) (fined|penali[sz]ed|reported|punished|noted|marked)|(paid|"
            r"payment|credits?|reward|voucher|compensat\w+|money)[^.]* only [^.]*(finish|complet)|"
            r"only [^.]*(finish|complet)[^.]*(paid|payment|credits?|reward|voucher|compensat|"
            r"money)|(lower|worse) (grade|mark)|(teacher|supervisor|boss|employer|lecturer|manager|"
            r"professor)[^.]*(told|informed|know)|(tell|inform) your (teacher|supervisor|boss|"
            r"employer|lecturer|manager|professor)|(teacher|supervisor|boss|employer|lecturer|"
            r"manager|professor)[^.]*(hear|notified|learns?\b)|costs? (you )?(half|part|a (part|"
            r"third|quarter)|\d+ \w+|the (payment|reward))|(only|just) half (of )?(the|your) (pay|"
            r"payment|reward|money)"
        ),
        "de": (
            r"verlier\w*|(erhal|bekomm)\w+ (\w+ ){0,2}(kein\w*|nichts)|(entfallt|verfallt|"
            r"abgezogen)|kein\w* (vergutung|geld|punkt\w*|bezahlung|aufwandsentschadigung|"
            r"versuchspersonenstund\w*)|nur wer|nicht (bezahlt|vergutet|angerechnet|"
            r"gutgeschrieben)|gemeldet|bestraft|durchgefallen|(vorgesetzt|chef|lehr|dozent|"
            r"arbeitgeber|professor)\w* (\w+ )?(erfahrt|wird (\w+ )?(informiert|benachrichtigt))|"
            r"kostet sie|nur (die halfte|einen teil)"
        ),
        "fr": (
            r"perd\w*|(aucune?|pas de|sans) (remuneration|paiement|credit|point)|signal|penali|"
            r"sanction|(chef|professeur|enseignant|superieur|employeur)\w* (\w+ )?(saura|sera "
            r"(informe|averti)|l'apprendra)|(seulement|que) la moitie"
        ),
        "es": (
            r"perder\w*|pierd\w*|no (recib|cobr)\w*|sin (pago|creditos?|remuneracion)|penaliz\w*|"
            r"(jef[ea]|profesor|superior|empleador)\w* (\w+ )?(sabra|se enterara|sera informad)|"
            r"solo la mitad"
        ),
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
            r"(sans|ne|aucun\w*) (\w+ ){0,3}(perd|consequence|penalite|prejudice|sanction)|quand "
            r"meme|meme si"
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
            r"that)\b[^.;]*(cannot|can ?not|can't|can no longer|could not|will not|won't|will "
            r"never|may not|must not|never) be (deleted|removed|erased|withdrawn|destroyed|taken "
            r"back)|no (right|possibility|way) (to|of) (\w+ ){0,4}(delet|eras|remov)"
        ),
        "de": (
            r"(daten|aufzeichnungen|antworten|ergebnisse|was|alles)[^.;]*(nicht|nie) (mehr |wieder "
            r")?(geloscht|entfernt|vernichtet|zuruckgezogen)|(kein|keine) (recht auf )?loschung"
        ),
        "fr": (
            r"(donnees|enregistrements|reponses)[^.;]*ne (peuvent|pourront|seront|sont) (pas|plus|"
            r"jamais) (etre )?(effac|supprim|detrui|retir)"
        ),
        "es": (
            r"(datos|grabaciones|respuestas)[^.;]*no (se )?(podran|pueden|podra|puede|seran)[^.;]* "
            r"?(borra|elimina|suprimi|retira)"
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
            r"(with|under|next to|beside|alongside) your (full |real |own |first |last )?names?\b|"
            r"names? and (results|data|answers|scores|times)|your name (is|will be) (written|"
            r"stored|kept|saved|noted|put) (next|beside|with|on the|in the)"
        ),
        "de": (
            r"(unter|mit|neben|bei) (ihrem|deinem) (vollen |echten |eigenen )?namen\b|(ihr|dein) "
            r"name (steht|wird|ist)\b[^.;]*\b(neben|bei|mit|zusammen|zu) "
        ),
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
            r"fast))\b[^.;]*\b(shown|given|passed|sent|reported|available|told|forwarded|"
            r"communicated|visible|disclosed) (on )?to (your|the) (\w+ )?(employer|teacher|"
            r"lecturer|professor|supervisor|manager|boss|insur\w+|doctor|trainer|coach|company|"
            r"school|team leader)|(employer|teacher|lecturer|professor|supervisor|manager|boss|"
            r"insur\w+|trainer|coach|company|school)\b[^.;]*\b(gets|receives|sees|will (get|"
            r"receive|see)) (your |the |all )?(\w+ )?(results?|scores?|times|data|answers|"
            r"recordings)|(data|recordings|answers|results) [^.;]*\bbe sold\b|sell (your |the "
            r")?(data|recordings)"
        ),
        "de": (
            r"(ergebnis|leistung|daten|zeiten|antworten|aufzeichnung)\w*\b[^.;]*\b(arbeitgeber|"
            r"lehr(er|kraft)|lehrerin|dozent|professor|vorgesetzt|chef|versicherung|krankenkasse|"
            r"trainer|schule|firma|betrieb)\w*[^.;]*(gezeigt|weitergegeben|weitergeleitet|"
            r"mitgeteilt|ubermittelt|gemeldet|vorgelegt|zugesandt)|(arbeitgeber|lehrer|lehrkraft|"
            r"dozent|vorgesetzt|chef|versicherung|krankenkasse|trainer)\w*[^.;]*(erhalt|bekommt|"
            r"sieht|erfahrt)[^.;]*(ergebnis|leistung|daten|zeiten|antworten)|(daten|"
            r"aufzeichnungen)[^.;]*verkauf"
        ),
        "fr": (
            r"(resultats?|performances?|donnees|temps|reponses)\b[^.;]*(transmis|communiqu|montr|"
            r"envoy|remis)\w* (a|au) (votre |l'|la |le )?(employeur|professeur|enseignant|"
            r"superieur|assur|medecin|chef|entraineur|ecole|entreprise)\w*|donnees[^.;]*vend(u|re)|"
            r"(professeur|employeur|chef|enseignant|medecin)\w* (\w+ )?(recevra|"
            r"verra)[^.;]*(resultats?|donnees|temps|performances?)"
        ),
        "es": (
            r"(resultados?|datos|tiempos|respuestas|rendimiento)\b[^.;]*(mostr|envi|entreg|comunic|"
            r"inform|transmit)\w* (a|al) (su |la |tu )?(jef[ea]|profesor|empleador|empresa|"
            r"aseguradora|medic|superior|entrenador|escuela)\w*|datos[^.;]*vend|(profesor|jef[ea]|"
            r"empleador|empresa|medic)\w* (\w+ )?(recibira|vera|tendra)[^.;]*(resultados?|datos|"
            r"tiempos|rendimiento)"
        ),
    }
)
"""Data of a person that go to people who have power over them."""
UNLINKED = Phrases(
    {
        "en": (
            r"not even (we|the (researchers|experimenters))|nobody,? (not even|including) (us|we)|"
            r"impossible to (link|trace)|(fully|completely|totally|strictly) anonymous"
        ),
        "de": (
            r"auch wir (\w+ )?nicht|nicht einmal wir|(vollstandig|vollig|komplett|absolut|strikt) "
            r"anonym"
        ),
        "fr": (
            r"pas meme nous|(entierement|totalement|completement|strictement) anonymes?|impossible "
            r"de (relier|remonter)"
        ),
        "es": (
            r"ni siquiera nosotros|(totalmente|completamente|absolutamente|estrictamente) "
            r"anonim\w*|imposible (vincular|relacionar)"
        ),
    }
)
ERASED = Phrases(
    {
        "en": (
            r"(delet|eras|remov)\w*[^.]*\b(code|later|afterwards|number|pseudonym)|(code|later|"
            r"afterwards|number|pseudonym)\b[^.]*\b(delet|eras|remov)"
        ),
        "de": (
            r"(losch)\w*[^.]*\b(kurzel\w*|code\w*|nachtraglich|spater|pseudonym\w*)|(kurzel\w*|"
            r"code\w*|nachtraglich|spater|pseudonym\w*)\b[^.]*losch"
        ),
        "fr": (
            r"(effac|supprim)\w*[^.]*\b(code|plus tard|pseudonyme)|(code|plus tard|"
            r"pseudonyme)\b[^.]*(effac|supprim)"
        ),
        "es": (
            r"(borr|elimin|suprim)\w*[^.]*\b(codigo|despues|mas tarde|seudonimo)|(codigo|despues|"
            r"mas tarde|seudonimo)\b[^.]*(borr|elimin|suprim)"
        ),
    }
)
"""That nobody knows whose data are whose, and that data of one person are deleted."""
LATER = Phrases(
    {
        "en": r"after\w*|then|later|once|until|as soon as",
        "de": r"danach|nach\b|spater|sobald|dann|bis\b",
        "fr": r"apres|ensuite|des que|jusqu|alors",
        "es": r"despues|luego|una vez|hasta|tras",
    }
)
"""A time from which on this is so."""

FREE = Phrases(
    {
        "en": (
            r"not (required|obliged|mandatory)|stop|stops|withdraw\w*|quit|leave|leaving|"
            r"voluntar\w*|break off|drop out|discontinu\w*|interrupt|free to|freely|any ?time|any "
            r"(moment|point|stage)|whenever|end (the|your|this)|sheet|leaflet|information|paper|"
            r"document|letter|brochure"
        ),
        "de": (
            r"nicht verpflicht\w*|aufhor\w*|abbrech\w*|abbruch|beenden|zuruckzieh\w*|zurucktret\w*|"
            r"widerruf\w*|freiwillig\w*|jederzeit|unterbrech\w*|aussteig\w*|\w*blatt|\w*schreiben|"
            r"unterlagen|aufklarung\w*|\w*information\w*"
        ),
        "fr": (
            r"arret\w*|interromp\w*|retir\w*|quitt\w*|volont\w*|benevol\w*|tout moment|librement|"
            r"libre|abandon\w*|notice|feuille|lettre|document|information\w*"
        ),
        "es": (
            r"parar|deten\w*|retir\w*|abandon\w*|interrump\w*|volunt\w*|cualquier momento|libre\w*|"
            r"dejar\w*|hoja|carta|documento|informacion"
        ),
        "it": (
            r"interromp\w*|ritir\w*|smett\w*|abbandon\w*|volontari\w*|qualsiasi momento|ogni "
            r"momento|liber\w*|foglio|lettera|documento|informa\w*|ferma\w*"
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
        if not text:
            # The language is missing, which is a mistake of form.
            continue
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
        unlinked = next(
            (
                s
                for s in sentences(text)
                if UNLINKED.match(s, language) and not LATER.match(s, language)
            ),
            None,
        )
        again = design.sessions > 1 or ERASED.match(text, language)
        if unlinked is not None and again and not ERASED.match(unlinked, language):
            yield Flaw(
                PLACE,
                f"consent{where} is untrue where it says {quoted(unlinked)}: a code links the "
                + ("sessions" if design.sessions > 1 else "data that are to be deleted")
                + " to the person",
                "Write that data are kept under a code, and who knows it",
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
