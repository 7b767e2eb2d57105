"""Questions that ask who somebody is: by their words, in several languages, and by their form."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sandbox.study.design.design import Item
from sandbox.study.design.told.plain import plain

NUMBER = "a number that belongs to one person"
WORDS = {
    "a name": (
        r"(your|full|first|last|family|given|maiden) names?|surname|initials|signature|"
        r"initiales|iniciales|iniziali|initialen|voorletters|unterschrift|handtekening|"
        r"names? of your (employer|company|doctor|supervisor|teacher|boss|partner|spouse)|"
        r"ihr name|ihren namen|vorname\w*|nachname\w*|familienname\w*|wie heissen sie|initialen|"
        r"(votre|vos) noms?|nom de famille|prenoms?|comment vous appelez|"
        r"(su|tu) nombre|nombre y apellidos?|apellidos?|como se llama|como te llamas|"
        r"(il suo|il tuo) nome|cognome|come si chiama|come ti chiami|"
        r"(uw|je) naam|voornaam|achternaam|hoe heet|"
        r"(seu|teu) nome|sobrenome|apelido|como se chama|"
        r"(ditt|dit) (namn|navn)|fornamn|efternamn|fornavn|efternavn|etternavn|"
        r"vad heter|hvad hedder|"
        r"imie i nazwisko|nazwisko|jmeno|prijmeni|имя|фамилия|фамилию|姓名|名字|名前|氏名|이름"
    ),
    "an address": (
        r"e-?mails?|e-?mail ?adres\w*|courriel|correo( electronico)?|posta elettronica|"
        r"(home|postal|street|mailing) address|address|adress\w*|anschrift|wohnort|postleitzahl|"
        r"(post|zip) ?codes?|adresse|domicilio|direccion|indirizzo|endereco|adres\w*|адрес|почта|"
        r"住所|地址|邮箱|メール|주소|이메일|"
        r"(reach|contact) you|sie erreichen|vous joindre|contactarle|plz|"
        r"codes? posta(l|le|ux)|codigo postal|codice postale|postnummer|psc|kod pocztowy|индекс|"
        r"house number|hausnummer|woonplaats|(your|the|which) street|"
        r"(ihre|deine|welche) strasse|邮编|郵便番号"
    ),
    "a telephone number": (
        r"(tele)?phones?|mobile|cell ?phone|whatsapp|handynummer|handy|telefon\w*|rufnummer|"
        r"portable|movil|cellulare|telemovel|celular|gsm|телефон|電話\w*|电话|手机|전화"
    ),
    "a birth date": (
        r"dates? of birth|birth ?(date|day)s?|d\.?o\.?b|born on|when were you born|day .* born|"
        r"geburts(tag|datum)\w*|wann .*geboren|geboren am|"
        r"date de naissance|anniversaire|quand etes-vous nee?|"
        r"fecha de nacimiento|cumpleanos|cuando nacio|data di nascita|compleanno|quando e nat[oa]|"
        r"geboortedatum|verjaardag|data de nascimento|aniversario|fodelsedag|fodelsedatum|"
        r"fodselsda\w+|data urodzenia|datum narozeni|дата рождения|生日|出生日期|誕生日|생년월일"
    ),
    NUMBER: (
        r"(student|matriculation|enrol?ment|passport|insurance|social security|employee|staff|"
        r"personnel|patient) (id|numbers?)|ssn|iban|matrikel\w*|personalnummer|ausweis\w*|"
        r"versicherungsnummer|patientennummer|numero (d'?etudiant|de securite sociale|etudiant)|"
        r"dni|nif|numero de matricula|codice fiscale|matricola|studentnummer|bsn|cpf|personnummer|"
        r"kundennummer|kontonummer|mitarbeiternummer|steuernummer|rentennummer|"
        r"(student|staff|employee|identity|id|insurance|health|library|campus|university)"
        r"('?s)? cards?|(student|insurance|employee|staff|customer|account|tax|nhs|identity|"
        r"membership|roll|registration)('?s)? (numbers?|no\.?|id)|(last|first) (\w+ )?digits of|"
        r"(letzten|ersten) (\w+ )?(ziffern|stellen)|derniers chiffres|premiers chiffres|"
        r"ultim[oa]s (\w+ )?(digitos|cifras|numeros)|ultime (\w+ )?cifre|laatste (\w+ )?cijfers|"
        r"carte (d'?etudiant|d'?identite|vitale)|numero (d'?inscription|ine|de carte|"
        r"d'?employe|d'?assure|de tarjeta|de empleado|de estudiante|de la seguridad social|"
        r"di matricola|di tessera)|matricule|carne de estudiante|tarjeta (sanitaria|"
        r"universitaria)|tessera sanitaria|personeelsnummer|klantnummer|rijksregisternummer|"
        r"pesel|паспорт|学号|学籍番号|学生番号|학번"
    ),
    "a photograph": (
        r"(photo(graph)?s?|picture|portrait|image) of (you|your face|yourself)|(your|a) "
        r"(photo(graph)?|selfie|portrait)|selfies?|passfoto|lichtbild|(foto|bild) von "
        r"(ihnen|sich|dir)|photo de (vous|votre)|foto (de usted|suya|de su|di lei|van u|"
        r"van uzelf)|照片|顔写真"
    ),
    "an account": (
        r"user ?names?|account ?names?|login|screen ?names?|nick ?names?|(instagram|facebook|"
        r"twitter|tiktok|linkedin|discord|skype|telegram|wechat|snapchat|github|reddit)"
        r"[ -]?(accounts?|names?|handles?|profiles?|profil|id)|benutzer(name\w*|konto)|"
        r"nutzername\w*|kontoname\w*|nom d'?utilisateur|nombre de usuario|nome utente|"
        r"gebruikersnaam|nome de usuario|用户名|微信号|ユーザー名"
    ),
    "the address of a device": (
        r"ip[ -]?(address|adresse|adres|number)|adresse ip|direccion ip|indirizzo ip|"
        r"mac[ -]address|serial number of your|seriennummer (ihres|deines)"
    ),
    "a number plate": (
        r"(number|licen[cs]e|registration) plates?|(car|vehicle) registration|"
        r"(auto|kfz-?|nummern)kennzeichen|nummernschild|plaque (d'?immatriculation|"
        r"mineralogique)|matricula de (su|tu) (coche|vehiculo|auto)|targa|kenteken|车牌"
    ),
}
"""What a question asks for, and its words, without accents and in lower case: English, German,
French, Spanish, Italian, Dutch, Portuguese, Swedish, Danish, Norwegian, Polish, Czech, Russian,
Chinese, Japanese and Korean."""

_PATTERNS = {what: re.compile(rf"(?<!\w)(?:{words})(?!\w)") for what, words in WORDS.items()}
# Words of these scripts are not separated.
_JOINED = re.compile(r"[぀-ヿ一-鿿가-힣]")

FORMS = {
    "a birth date": re.compile(
        r"\b(?:dd|tt|jj|gg|d{1,2})[./ -](?:mm|m)[./ -](?:y{2,4}|j{2,4}|a{2,4}|r{2,4}|g{2,4})\b|"
        r"\b(?:yyyy|jjjj|aaaa)[./ -]mm[./ -](?:dd|tt|jj|gg)\b|\bmm/dd/y{2,4}\b"
    ),
    "an address": re.compile(r"\w@\w|(?<!\w)@(?!\w)"),
    "a telephone number": re.compile(r"\+\d{1,3}[ \d(/-]{4,}"),
}
"""What an example of an answer in the text of a question gives away."""

LONGEST_NUMBER = 10**6
"""A number that may be this large tells people apart."""
DAY, MONTH = (1.0, 31.0), (1.0, 12.0)
"""Limits of days and months."""


WIDEST = 10**4
"""A number of fewer values, such as years or hours, tells nobody's name, address or birth date."""


def asks_for(item: Item) -> str:
    """What identifying thing one question asks for; empty if none is seen.

    Choices, scales and numbers of few values are left out: the answer to "how often do you use a
    phone?" is not a telephone number.
    """
    if item.kind in ("choice", "scale"):
        return ""
    if item.kind == "number" and item.high < WIDEST:
        # The last four digits of a number are few values, and tell people apart.
        pattern = _PATTERNS[NUMBER]
        return NUMBER if any(pattern.search(plain(text)) for text in item.ask.values()) else ""
    named = item.name.replace("_", " ").replace("-", " ")
    if plain(named) in ("name", "names"):
        return "a name"
    for text in (named, *item.ask.values()):
        words = plain(text)
        for what, pattern in _PATTERNS.items():
            match = pattern.search(words)
            if match or (_JOINED.search(words) and _contains(words, WORDS[what])):
                return what
        for what, form in FORMS.items():
            if form.search(words):
                return what
    if item.kind == "number" and item.high >= LONGEST_NUMBER and item.step == 1.0:
        return NUMBER
    return ""


def birth_parts(items: Sequence[Item]) -> list[Item]:
    """Numbers that are a birth date together: a day, and a month or a year."""
    numbers = [item for item in items if item.kind == "number"]
    days = [item for item in numbers if (item.low, item.high) == DAY]
    months = [item for item in numbers if (item.low, item.high) == MONTH]
    years = [item for item in numbers if 1850 <= item.low < item.high <= 2200]
    return [*days, *months, *years] if days and (months or years) else []


def _contains(text: str, words: str) -> bool:
    return any(
        word in text for word in words.split("|") if _JOINED.search(word) and "\\" not in word
    )
