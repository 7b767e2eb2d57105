"""Claims that the design contradicts: what is recorded, and who moves the second hand."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.conditions import (
    PARTNER,
    combinations,
    tasks_of,
    uses_camera,
    values_of,
)
from sandbox.study.design.design import END, Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import (
    CONSENT,
    GOAL,
    INSTRUCTION,
    Phrases,
    Told,
    quoted,
    sentences,
    told_texts,
)
from sandbox.study.design.told.words import DENIES, LEADER

_OTHER = (
    "recorded|stored|saved|measured|logged|kept|face|faces|voice|voices|names?|video|pictures?|"
    "photos?|sounds?|camera|audio|address"
)
_KEPT_EN = (
    "recorded|stored|saved|measured|logged|kept|collected|timed|tracked|registered|taken|noted"
)
_NOT_HERE = (
    r"(?! (with|alongside|together|beyond|longer|on|in|during|before|until|unless|between|outside|"
    r"while|under|except|but|other than|besides)\b)"
)

UNRECORDED = Phrases(
    {
        "en": (
            r"(touch(es)?|movements?|gestures?|motions?|fingers?|trials?|performance|times?|"
            r"durations?|speed|what you do|how (fast|long|quickly) [\w ]*)\b"
            rf"((?!\b({_OTHER})\b)[^.;,])*?\b((is|are|will be) (not|never)|isn't|aren't|won't be) "
            rf"({_KEPT_EN})\b{_NOT_HERE}|"
            r"((do|does|will|shall) (not|never)|don't|doesn't|won't|never) (record|store|save|"
            r"measure|"
            rf"log|keep|collect|track|time)\b((?!\b({_OTHER})\b)[^.;,])*?\b(touch(es)?|movements?|"
            r"gestures?|motions?|fingers?|times?|speed|performance|how (fast|long|quick\w*))\b(?! "
            r"[\w ]*\b(name|face|voice)\b)|(no|neither|not any|none of your) (touch(es)?|"
            r"movements?|gestures?|motions?|times?|durations?|timing|measurements?|data)( (of any "
            r"kind|at all|whatsoever|or \w+|nor \w+|"
            rf"about how \w+ you are))* (is|are|will be|gets?) ({_KEPT_EN})\b{_NOT_HERE}|"
            rf"nothing (\w+ ){{0,5}}(is|will be|gets) ({_KEPT_EN})\b{_NOT_HERE}|"
            r"only (your |the )?(\w+ )?(answers|questionnaires?|ratings|responses|opinions?)"
            rf"((?!\b(touch\w*|movements?|times?)\b)[^.;])* (is|are|will be) ({_KEPT_EN})\b|"
            r"(record|store|save|keep|collect)s? (only|nothing but|solely|exclusively|just) (your |"
            r"the )?(\w+ )?(answers|questionnaires?|ratings|responses|opinions?)\b(?! (and|,))|the "
            r"only (thing|data) (that )?(we|the program|it) (\w+ )?(keep|record|store|save)s? (is|"
            r"are) (your |the )?(\w+ )?(answers|questionnaires?|ratings|responses)|no recordings? "
            r"(is|are|will be) made\b(?! (of|with) (your )?(face|voice|name))|no data (about|on|"
            r"from|of) you (is|are|will be) (\w+ )?(collected|recorded|stored|saved|kept)\b(?! "
            r"(with|on|in|after|beyond))"
        ),
        "de": (
            r"(beruhrung\w*|bewegung\w*|finger\w*|geste\w*|zeit\w*|dauer|durchgang\w*|leistung\w*|"
            r"geschwindigkeit\w*|was sie tun)\b((?!\b(gesicht\w*|stimme\w*|name\w*|bild\w*|"
            r"video\w*|ton|kamera|pausen?|ubung\w*|bevor|ohne|aufgezeichnet|gespeichert|gemessen|"
            r"erfasst)\b)[^.;,])*?\b(nicht|nie|niemals|weder)( auch| irgendwie| weiter)? "
            r"(aufgezeichnet|gespeichert|gemessen|erfasst|protokolliert|festgehalten|aufgenommen|"
            r"erhoben|registriert|gestoppt)|kein\w* (\w+ )?(zeit(en)?|beruhrung\w*|bewegung\w*|"
            r"daten|dauer|messung\w*|geschwindigkeit\w*|gesten)\b((?!\b(im|in|auf|an|ausserhalb|"
            r"uber)\b)[^.;,])*(gemessen|aufgezeichnet|gespeichert|erfasst|erhoben|gestoppt|"
            r"genommen)|(?<!ausser )(es wird )?nichts( davon| weiter)? (aufgezeichnet|gespeichert|"
            r"gemessen|erfasst|erhoben)|(nur|ausschliesslich|lediglich|allein) (ihre|die|deine) "
            r"(\w+ )?(antworten|angaben|fragebog\w*|einschatzung\w*)((?!\b(und|"
            r"sowie)\b)[^.;])*(gespeichert|aufgezeichnet|erfasst|erhoben|festgehalten)|"
            r"(gespeichert|aufgezeichnet|erfasst|erhoben|festgehalten|speichern|erfassen|erheben) "
            r"(werden |wird |wir )?(nur|ausschliesslich|lediglich|allein) (ihre |die )?(\w+ "
            r")?(antworten|angaben|fragebog\w*|einschatzung\w*)\b(?!,? (und|sowie))|(zeichn|"
            r"speicher|mess|stopp|erfass|protokollier|erheb)\w* (wir |das programm |hier )?(gar |"
            r"uberhaupt )?(nichts\b(?! ausser|,? was| uber)|kein\w* (\w+ )?(zeit|beruhrung|"
            r"bewegung|daten\b|geste|dauer))|(zeichn|speicher|mess|erfass|erheb)\w* (wir |das "
            r"programm )?(nur|ausschliesslich|lediglich),? (das, )?was [^.]*(frageb|antwort|"
            r"ankreuz)"
        ),
        "fr": (
            r"(toucher\w*|contacts?|mouvements?|gestes?|doigts?|temps|durees?|essais?|vitesse|"
            r"performances?)\b((?!\b(visage|voix|noms?|image\w*|video|camera|"
            r"enregistre\w*)\b)[^.;,])*?\b(ne |n')\w+ (pas|jamais|plus)( ete)? (enregistre|mesure|"
            r"conserve|chronometre|stocke|collecte|garde|note)\w*(?! (avec|sous|pendant|durant|"
            r"avant|au-dela))|(aucune?|ni) (temps|durees?|mouvements?|gestes?|touchers?|contacts?|"
            r"donnees?|mesures?|vitesse)\b[^.;,]*\b(n'est|ne sera|ne sont|n'etait)( \w+)? "
            r"(enregistre|mesure|conserve|stocke|collecte|chronometre|prise?)\w*|rien (de cela |"
            r"d'autre )?(n'est|ne sera) (enregistre|mesure|conserve|collecte)\w*|n'(enregistr|"
            r"mesur|conserv|collect|chronometr)\w+ (pas|ni|aucun\w*|jamais) ([\w']+ )?(touchers?|"
            r"contacts?|mouvements?|gestes?|temps|durees?|vitesse)|ne (mesurons|gardons|conservons|"
            r"collectons|chronometrons) (pas|ni|aucun\w*) ([\w']+ )?(touchers?|contacts?|"
            r"mouvements?|gestes?|temps|durees?|vitesse)|(seules|uniquement|seulement|"
            r"exclusivement) (vos|les) reponses\b((?!\bet\b)[^.;])*(enregistre|conserve|stocke|"
            r"collecte|garde)|n'(enregistrons|conservons|collectons) que (vos|les) reponses|"
            r"(enregistrons|conservons|collectons) (uniquement|seulement) (vos|les) reponses\b(?! "
            r"et)|ne (memoris|retien|mesur|gard|conserv|collect|chronometr|stock)\w* (rien\b|(pas|"
            r"ni|aucun\w*) ([\w']+ )?(touchers?|contacts?|mouvements?|gestes?|temps|durees?|"
            r"vitesse))|n'enregistr\w+ rien\b"
        ),
        "es": (
            r"(toques?|movimientos?|gestos?|dedos|tiempos?|duracion\w*|ensayos?|velocidad|"
            r"rendimiento)\b((?!\b(rostro|cara|voz|nombres?|imagen\w*|video|camara|registr\w+|"
            r"grab\w+)\b)[^.;,])*?\b(no|nunca) (se )?(sera\w* |son |estan |queda\w* )?(registr|"
            r"grab|guard|mid|med|almacen|recog|cronometr)\w*(?! (con|bajo|durante|antes|fuera))|no "
            r"(se )?(le )?(registr|grab|guard|mid|med|almacen|recog|cronometr|tom)\w* "
            r"((?!\b(rostro|cara|voz|nombres?|imagen\w*|video|camara)\b)[^.;,])*?\b(toques?|"
            r"movimientos?|gestos?|tiempos?|dedos|velocidad|duracion)\b|(nada (se|sera) (registr|"
            r"grab|guard|almacen)\w*|no (se )?(registr|grab|guard|almacen)\w* nada)|ningun\w* "
            r"(dato|tiempo|movimiento|toque|gesto)s? (se|sera|es)\b[^.;,]*(registr|grab|guard|mid|"
            r"almacen)\w*|(solo|solamente|unicamente|exclusivamente) (se )?(guard|registr|grab|"
            r"almacen|recog)\w* (sus|tus|las) respuestas\b(?! y)|(solo|solamente|unicamente|"
            r"exclusivamente) (sus|tus|las) respuestas\b((?! y )[^.;])*(guard|registr|grab|almacen|"
            r"recog)|no (se )?(mid|cronometr|registr)\w* (cuanto|como)\b"
        ),
        "it": (
            r"(tocch\w*|movimenti|gesti|dita|temp[oi]|durat\w*|prove|velocita)\b((?!\b(volto|viso|"
            r"voce|nome|immagin\w*|video)\b)[^.;,])*?\bnon (viene|vengono|sono|e|sara|saranno) "
            r"(registrat|misurat|salvat|conservat|raccolt|memorizzat|cronometrat)\w*|non (registr|"
            r"misur|salv|conserv|raccogl)\w* ((?!\b(volto|viso|voce|nome)\b)[^.;,])*?\b(tocch\w*|"
            r"movimenti|gesti|temp[oi]|durata|velocita)\b|nessun\w* (tempo|movimento|tocco|gesto|"
            r"dato) (viene|e|sara) (registrat|misurat|salvat|conservat|raccolt)\w*|(solo|soltanto|"
            r"esclusivamente|unicamente) le (sue |tue )?risposte\b(?! e)"
        ),
        "nl": (
            r"(aanraking\w*|beweging\w*|gebaren|vingers?|tijd\w*|duur|snelheid)\b((?!\b(gezicht|"
            r"stem|naam|beeld|video)\b)[^.;,])*?\bniet (opgenomen|opgeslagen|gemeten|vastgelegd|"
            r"bewaard|geregistreerd)|geen (tijd\w*|aanraking\w*|beweging\w*|gegevens|data) (\w+ "
            r"){0,2}(opgenomen|opgeslagen|gemeten|vastgelegd|bewaard)|(alleen|uitsluitend) (uw|je|"
            r"de) antwoorden\b(?! en)"
        ),
        "pt": (
            r"(toques?|movimentos?|gestos?|dedos|tempos?|duracao|velocidade)\b((?!\b(rosto|voz|"
            r"nome|imagem|video)\b)[^.;,])*?\bnao (sao|sera|serao|e) (registrad|gravad|guardad|"
            r"medid|armazenad|recolhid|coletad)\w*|(so|somente|apenas|exclusivamente) (as )?(suas "
            r")?respostas\b(?! e)"
        ),
        "zh": (
            r"(不|没有|不会)(会)?(记录|保存|测量|收集|存储)(您的|任何)?(触摸|动作|时间|移动|手指|"
            r"数据)|(触摸|动作|时间|手指)[^。，]{0,6}(不|不会)(被)?(记录|保存|测量)|(只|"
            r"仅)(会)?(记录|保存|收集)(您的)?(回答|答案|问卷)(?!和|与|、)"
        ),
        "ja": (
            r"(タッチ|動き|動作|時間|指)[^。、]{0,6}(記録|測定|保存|計測)(は)?(しません|されません|"
            r"いたしません|することはありません)|(回答|答え)(のみ|だけ)(を|が)?(記録|保存|収集)"
        ),
        "ar": r"(لا|لن) (نسجل|يتم تسجيل|نقيس|يسجل|تسجل|يقاس)[^.،]{0,20}(لمس|حرك|وقت|زمن)",
    }
)
"""Denials that touches and times are recorded, which they always are."""

NO_CAMERA = Phrases(
    {
        "en": (
            r"(no|without (a|any)) (web ?)?camera\b|(web ?)?camera (is|stays|remains) (switched "
            r")?off\b"
        ),
        "de": r"(keine|ohne) (web)?(kamera|cam)|(web)?(kamera|cam) (ist|bleibt) (aus|ab)",
        "fr": r"(pas de|aucune|sans) (camera|webcam)|(camera|webcam) (est|reste) (eteinte|coupee)",
        "es": r"(sin|ninguna|no (hay|se usa)( ninguna)?) (camara|webcam)|camara (esta )?apagada",
        "it": r"(senza|nessuna) (telecamera|webcam|fotocamera)",
        "nl": r"(geen|zonder) (camera|webcam)",
        "zh": r"(不|没有)(使用|打开)?摄像头",
        "ja": r"カメラは(使|使用)(いません|しません)",
    }
)
"""Denials of a camera."""

PERSON = Phrases(
    {
        "en": (
            r"(another|(the |a )?second|(the |an )?other|a fellow|a real|a human) (participant|"
            r"person|player|student|volunteer|human|partner|user)|someone else|somebody else|(your|"
            r"a|the) (human )?partner\b|(next|other|different|adjacent|neighbou?ring) room|next "
            r"door|(a|your|my) colleague|team ?mate"
        ),
        "de": (
            r"(eine?[rnm]?|die|der|den|dem|ihr[em]?) (andere|zweite|weitere|echte|reale)[rnms]? "
            r"(person|teilnehm|versuchsperson|mensch|spieler|student|proband|partner)\w*|nebenraum|"
            r"nachbarraum|nebenzimmer|raum nebenan|nebenan|ihr(e|em|en|er)? (\w+ )?partner(in)?\b|"
            r"(mit|von) eine[rm] (\w+ )?partner(in)?\b|mitspieler\w*|jemand(em|en)? ander"
        ),
        "fr": (
            r"(une? autre|l'autre|une? seconde?|une? vraie?) (participant|personne|joueu|etudiant|"
            r"partenaire)\w*|(votre|un|une) partenaire|(piece|salle|chambre) (voisine|d'a cote|a "
            r"cote)|quelqu'un d'autre|coequipier\w*"
        ),
        "es": (
            r"(otr[oa]|segund[oa]) (participante|persona|jugador|estudiante|voluntari)\w*|(su|un|"
            r"una|tu) (companer[oa]|pareja)|(sala|habitacion|cuarto) (de al lado|contigu[oa]|"
            r"vecin[oa])|alguien mas"
        ),
        "it": (
            r"(un altro|un'altra|un secondo|una seconda) (partecipante|persona|giocat|studente)\w*|"
            r"(il suo|la sua|un|una|il tuo) (compagn[oa]|partner)|(stanza|sala) (accanto|vicina)|"
            r"qualcun altro"
        ),
        "nl": (
            r"(een andere|een tweede|de andere) (deelnem|persoon|spel|student)\w*|(uw|je|een) "
            r"partner\b|kamer (hiernaast|ernaast)|iemand anders"
        ),
        "pt": (
            r"(outr[oa]|segund[oa]) (participante|pessoa|jogador|estudante)\w*|(seu|sua|um|uma) "
            r"(parceir[oa]|colega)|sala ao lado|outra pessoa"
        ),
        "zh": r"另(一|外一)(位|名|个)(参与者|人|玩家|学生)|(您|你)的(搭档|伙伴|队友)|隔壁",
        "ja": r"(別|他|もう一人)の(参加者|人|プレイヤー)|(あなたの)?(パートナー|相手)|隣の部屋",
        "ar": r"مشارك(ة)? (آخر|اخر|أخرى|اخرى)|شخص (آخر|اخر)|شريك|الغرفة المجاورة",
    }
)
"""People beside the participant."""
SHARED = Phrases(
    {
        "en": (
            r"\w*hand\b|mov\w+|carr\w+|together|control\w*|steer\w*|lift\w*|hold\w*|play\w*|room|"
            r"team\w*|partner|next door"
        ),
        "de": (
            r"\w*hand\b|beweg\w*|trag\w*|gemeinsam|zusammen|steuer\w*|heb\w*|halt\w*|spiel\w*|"
            r"\w*raum"
        ),
        "fr": (
            r"main|boug\w*|deplac\w*|port\w*|ensemble|command\w*|soulev\w*|tien\w*|jou\w*|piece|"
            r"salle"
        ),
        "es": r"mano|muev\w*|mov\w*|llev\w*|junt[oa]s|control\w*|levant\w*|sujet\w*|jueg\w*|sala",
        "it": r"mano|muov\w*|port\w*|insieme|control\w*|sollev\w*|gioc\w*|stanza",
        "nl": r"\w*hand\b|beweeg\w*|draag\w*|samen|bestuur\w*|til\w*|speel\w*|kamer",
        "pt": r"mao|mov\w*|lev\w*|junt[oa]s|control\w*|levant\w*|jog\w*|sala",
        "zh": r"手|移动|搬|一起|控制|房间",
        "ja": r"手|動か|運|一緒|操作|部屋",
        "ar": r"يد|تحر|يحر|حمل|معا|غرفة",
    }
)
"""Words of doing something together."""
MACHINE = Phrases(
    {
        "en": (
            r"(simulated|virtual|artificial|automatic|automated|programmed|computer\w*|robot\w*|"
            r"machine|ai)([ -](controlled|generated|driven|moved|based))? (partner|person|user|"
            r"player|participant|agent|human|colleague|team ?mate|helper)|(partner|second hand|"
            r"other hand|it)\b[^.]*\b(is|was|are|were) (\w+ )?(simulated|controlled by|moved by|"
            r"steered by|played by|a (computer|program|robot|machine|simulation)|software|not (a |"
            r"another )?(person|human|real))|(computer|program|software|algorithm|robot|simulation|"
            r"machine|ai) (itself )?(moves?|controls?|steers?|plays?|guides?|moved|controlled|"
            r"steered|played|guided|takes?|took|carries|helps)|by (a|the|our|an) (\w+ )?(computer|"
            r"program|software|algorithm|robot|machine|simulation|ai)\b|no (human|(other |second "
            r")?person)\b"
        ),
        "de": (
            r"(simulierte|virtuelle|kunstliche|computergesteuerte|automatische)\w* (partner|person|"
            r"mitspieler|mensch|spieler|teilnehm|agent)\w*|(computer|programm|rechner|software|"
            r"algorithmus|roboter|simulation|ki)\b[^.]*(bewegt|steuert|fuhrt|ubernimmt|spielt|"
            r"tragt|gesteuert)|(vom|von eine[rm]|durch (ein|einen|das|den)|von der) (\w+ "
            r")?(computer|programm|rechner|algorithmus|roboter|software|simulation|ki)\w*|(zweite|"
            r"andere) hand[^.]*simuliert|kein mensch|keine (andere )?person"
        ),
        "fr": (
            r"(partenaire|personne|joueur|participant\w*) (simule|virtuel|artificiel)\w*|"
            r"(ordinateur|programme|logiciel|algorithme|robot|machine|simulation)\b[^.]*(guid|"
            r"dirig|boug|deplac|command|control|jou|pilot|port|bouge)\w*|par (l'ordinateur|un "
            r"ordinateur|(le|un) (programme|logiciel|robot|algorithme))|(seconde|autre|deuxieme) "
            r"main[^.]*simule"
        ),
        "es": (
            r"(companer[oa]|persona|pareja|participante) (simulad|virtual|artificial)\w*|"
            r"(ordenador|computador\w*|programa|robot|algoritmo|simulacion)\b[^.]*(muev|movi|guia|"
            r"control|manej|dirig|llev)\w*|por (el|un|una|la) (ordenador|computador\w*|programa|"
            r"robot|algoritmo)|(segunda|otra) mano[^.]*simulad"
        ),
        "it": (
            r"(compagn[oa]|persona|partner|partecipante) (simulat|virtual|artificial)\w*|(computer|"
            r"programma|robot|algoritmo)\b[^.]*(muov|guid|controll|port)\w*|(dal|da un) (computer|"
            r"programma|robot|algoritmo)"
        ),
        "nl": (
            r"(gesimuleerde|virtuele|kunstmatige) (partner|persoon|deelnemer)|(computer|programma|"
            r"robot|algoritme)\b[^.]*(beweegt|bestuurt|stuurt|draagt)|door (de|een|het) (computer|"
            r"programma|robot|algoritme)"
        ),
        "pt": (
            r"(parceir[oa]|pessoa|participante) (simulad|virtual|artificial)\w*|(computador|"
            r"programa|robo|algoritmo)\b[^.]*(mov|gui|control|lev)\w*|(pelo|por um) (computador|"
            r"programa|robo)"
        ),
        "zh": (
            r"(模拟|虚拟|电脑|计算机|程序|机器人|人工智能)(的)?(搭档|伙伴|参与者|用户|控制|移动|"
            r"操作)"
        ),
        "ja": (
            r"(シミュレー|仮想|コンピュータ|プログラム|ロボット|人工知能|AI|ai)[^。]*(パートナー|"
            r"相手|動か|操作|制御)"
        ),
        "ar": r"(الحاسوب|الكمبيوتر|البرنامج|روبوت|محاك|افتراضي)[^.]*(يحر|تحر|شريك|يد)",
    }
)
"""That a program moves the second hand."""


TOUCHING = Phrases(
    {
        "en": (
            r"(touch|tap|press|place|put|rest|lay)\w* [^.;]*\b(on|onto) (the|your|a) (touch "
            r"?)?(screen|tablet|glass|surface)|touch the (screen|tablet|glass|surface)"
        ),
        "de": (
            r"(leg|setz|tipp|druck|beruhr)\w* [^.;]*\b(auf|den) (den |das |die )?(\w*bildschirm|"
            r"tablet|glas|oberflache)"
        ),
        "fr": (
            r"(pos|appuy|mett|touch)\w* [^.;]*\b(sur|l') ?(l'|la |le )?(ecran|tablette|vitre|"
            r"surface)"
        ),
        "es": (
            r"(pon|toqu|puls|coloqu|apoy)\w* [^.;]*\b(en|sobre|la) (la |el )?(pantalla|tableta|"
            r"superficie)"
        ),
    }
)
HOVERING = Phrases(
    {
        "en": (
            r"(hold|keep|place|move|put|raise)\w* [^.;]*\b(over|above|in front of|before) (the|a) "
            r"(\w+ )?(sensor|camera|webcam|leap|controller)"
        ),
        "de": (
            r"(halt|beweg|heb)\w* [^.;]*\b(uber|vor) (den|die|der|das|dem|eine[rnm]?) (\w+ "
            r")?(sensor|\w*kamera|webcam|leap)"
        ),
        "fr": (
            r"(ten|gard|plac|boug|mett|lev)\w* [^.;]*\b(au-dessus du|devant (la|le)|face a la) "
            r"(capteur|camera|webcam|leap)"
        ),
        "es": (
            r"(manten|pon|muev|coloqu|sosten)\w* [^.;]*\b(sobre|encima d|delante d|frente a)(el|e "
            r"la| el| la|e el)? ?(sensor|camara|webcam|leap)"
        ),
    }
)
"""Texts that tell people to touch a screen, and to hold a hand before a sensor."""


_BOXES = ("box-to-goal", "slalom", "books", "stack", "stack-three", "stack-vertical")
THINGS = (
    (
        Phrases(
            {
                "en": r"(?<!tick the )(?<!tick a )(?<!check the )(?<!text )(box|boxes|cubes?)\b",
                "de": r"(kiste|kisten|klotz|klotze|quader|wurfel)\b",
                "fr": r"(boites?|caisses?|cubes?)\b",
                "es": r"(cajas?|cubos?)\b",
            }
        ),
        (*_BOXES, "gather"),
    ),
    (
        Phrases(
            {
                "en": r"(wrench|wrenches|spanners?)\b",
                "de": r"(schraub\w*)?schlussel\b",
                "fr": r"(cle|clef|cles)\b(?! (de|du|des|d')\b)",
                "es": r"llaves?\b(?! de\b)",
            }
        ),
        ("wrench-turn", "wrench-slide"),
    ),
    (
        Phrases(
            {
                "en": r"(stack|stacks|stacking|pile up)\b",
                "de": r"stapel(n|t|e)?\b",
                "fr": r"empil\w*",
                "es": r"apil\w*",
            }
        ),
        ("stack", "stack-three", "stack-vertical"),
    ),
    (
        Phrases({"en": r"tray\b", "de": r"tablett\b", "fr": r"plateau\b", "es": r"bandeja\b"}),
        ("carry-together",),
    ),
)
"""Things that people are told of, and the tasks that have them."""


def claim_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what people are told about the study, one line for each cause."""
    yield from _unrecorded(design)
    yield from _hidden_partner(design)
    yield from _other_device(design)
    yield from _other_task(design)


def _said(design: Design, at_end: bool = False) -> Iterator[Told]:
    """The consent and all instructions, or those at the end."""
    for told in told_texts(design):
        if told.kind in (CONSENT, INSTRUCTION) and (told.at == END) is at_end:
            yield told


def _unrecorded(design: Design) -> Iterator[Flaw]:
    camera = uses_camera(design)
    for told in _said(design):
        for language, text in told.text.items():
            untrue = next((s for s in sentences(text) if UNRECORDED.match(s, language)), None)
            if untrue is not None:
                yield Flaw(
                    told.path,
                    "it is untrue, since every touch, movement and time is recorded: "
                    + quoted(untrue),
                    "Write that touches, times and answers are recorded",
                )
                break
            unseen = next((s for s in sentences(text) if NO_CAMERA.match(s, language)), None)
            if camera and unseen is not None:
                yield Flaw(
                    told.path,
                    f"it is untrue, since a camera sees the hand: {quoted(unseen)}",
                    "Write that a camera is on, and that its pictures stay in the page",
                )
                break


def _other_device(design: Design) -> Iterator[Flaw]:
    """Texts that describe a device which no trial uses."""
    every = [values_of(design, levels) for levels in combinations(design)]
    used = {
        str(values.get(key, "touch" if key == "device" else PARTNER))
        for values in every
        for key in ("device", "second_device")
    } - {PARTNER}
    if "touch" not in used:
        wrong, what = TOUCHING, "to touch a screen, and hands are in the air"
    elif used == {"touch"}:
        wrong, what = HOVERING, "to hold a hand before a sensor, and it is a touch screen"
    else:
        return
    for told in _said(design):
        for language, text in told.text.items():
            said = next(
                (
                    s
                    for s in sentences(text)
                    if wrong.match(s, language) and not DENIES.match(s, language)
                ),
                None,
            )
            if said is not None:
                yield Flaw(
                    told.path,
                    f"people are told {what}: {quoted(said)}",
                    "Describe the device of [settings], or change it there",
                )
                break


def _other_task(design: Design) -> Iterator[Flaw]:
    """Texts that describe a task which is not played."""
    tasks = set(tasks_of(design))
    if not tasks <= {task for _, some in THINGS for task in some}:
        return
    goals = list(design.page.goals)
    for told in told_texts(design):
        played = tasks
        if told.kind == GOAL and isinstance(told.path[1], int):
            played = {goals[told.path[1]]}
        elif told.kind != INSTRUCTION or told.at == END:
            continue
        for language, text in told.text.items():
            named = [some for phrases, some in THINGS if phrases.match(text, language)]
            if named and not any(played & set(some) for some in named):
                yield Flaw(
                    told.path,
                    f"it tells of another task than {' and '.join(sorted(played))}: "
                    + quoted(_telling(text, language)),
                    "Describe the task that is played, or change the task",
                )
                break


def _telling(text: str, language: str) -> str:
    """The first sentence that names a thing."""
    return next(
        s for s in sentences(text) if any(phrases.match(s, language) for phrases, _ in THINGS)
    )


def _hidden_partner(design: Design) -> Iterator[Flaw]:
    """A partner who is told to be a person, and is simulated, without a word of it afterwards."""
    every = (values_of(design, levels) for levels in combinations(design))
    if all(values.get("second_device") != PARTNER for values in every):
        return
    texts = [*_said(design), *_said(design, at_end=True)]
    for language in design.languages:
        if any(MACHINE.match(told.text[language], language) for told in texts):
            continue
        for told in _said(design):
            for sentence in sentences(told.text[language]):
                shared = PERSON.match(sentence, language) and SHARED.match(sentence, language)
                if shared and not LEADER.match(sentence, language):
                    yield Flaw(
                        told.path,
                        "people are told of somebody who moves the second hand; it is simulated, "
                        f"and nobody tells them afterwards: {quoted(sentence)}",
                        'Write that a program moves it, or tell them with at = "end"',
                    )
                    return
