// Runs before the rest of the page has come: the socket, the language, and the first words in it.

import { announce, base, choose } from "./language";
import { openEarly } from "./link";
import { sized } from "./window-size";

/** "Preparing the table" by language, put in by bundle.mjs. */
declare const PREPARING: Record<string, string>;

// A study's page comes with its language, and shows everything at its true size.
document.documentElement.dataset["study"] = document.documentElement.lang && "yes";
const code = document.documentElement.lang || choose(Object.keys(PREPARING));
announce(code);
document.querySelector(".preparing")!.textContent = PREPARING[base(code)] ?? "";
if (sized()) openEarly();
