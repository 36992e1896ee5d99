/** The forms of the language: what completion inserts, where each belongs, and what it means. */

import forms from "../../../lrp_jupyter/language/forms.json";

interface Form {
  /** The snippet that completion inserts after the bracket. */
  template: string;
  detail: string;
  /** The forms, by their names in the grammar, that it may stand in. */
  inside: string;
  /** As the language writes it. */
  usage: string;
  doc: string;
}

export const FORMS: Record<string, Form> = Object.fromEntries(
  Object.entries(forms).map(([keyword, [template, detail, inside, usage, doc]]) => [
    keyword,
    { template, detail, inside, usage, doc } as Form,
  ]),
);
