/** What the browser keeps, under names; a page without storage forgets. */

/** The entries of a storage whose names begin with a prefix. */
export class Kept {
  constructor(
    private readonly storage: () => Storage, // where there is none, the access itself fails
    private readonly prefix: string,
  ) {}

  get(name: string): string | null {
    return this.use((storage) => storage.getItem(this.prefix + name));
  }

  /** Returns whether the browser keeps it. */
  set(name: string, value: string): boolean {
    return this.use((storage) => storage.setItem(this.prefix + name, value)) !== null;
  }

  /** The names and values of all entries. */
  all(): [string, string][] {
    const { prefix } = this;
    const entries = this.use((storage) => Object.entries<string>(storage)) ?? [];
    return entries
      .filter(([key]) => key.startsWith(prefix))
      .map(([key, value]) => [key.slice(prefix.length), value]);
  }

  remove(concerns: (name: string) => boolean): void {
    for (const [name] of this.all())
      if (concerns(name)) this.use((storage) => storage.removeItem(this.prefix + name));
  }

  private use<T>(act: (storage: Storage) => T): T | null {
    try {
      return act(this.storage());
    } catch {
      return null; // there is none, or it is full
    }
  }
}

/** The user's choices, for all labs: sizes, hidden panels, switches. */
const choices = new Kept(() => localStorage, "lrp-kept:");

export const keep = (name: string, value: string) => void choices.set(name, value);
export const kept = (name: string) => choices.get(name);
export const forget = (name: string) => choices.remove((other) => other === name);
export const forgetAll = (concerns: (name: string) => boolean) => choices.remove(concerns);

/** Whether a switch is on; `usual` until the user has chosen. */
export function isOn(name: string, usual: boolean): boolean {
  const value = kept(name);
  return value === null ? usual : value === "on";
}

export function keepOn(name: string, on: boolean): void {
  keep(name, on ? "on" : "off");
}

/** A switch whose position is kept. `moved` is called when the user has moved it. */
export class KeptSwitch {
  on: boolean;

  constructor(
    private readonly name: string,
    usual: boolean,
    private readonly moved: () => void,
  ) {
    this.on = isOn(name, usual);
  }

  readonly flip = (): void => {
    this.on = !this.on;
    keepOn(this.name, this.on);
    this.moved();
  };
}
