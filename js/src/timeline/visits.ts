/** Questions about a visit of a state: why the state is active, and why it was entered or left. */

import { nameOf } from "../language/paths";
import { askWhy } from "../parts/why";
import type { Lab } from "../session/store";
import { item, type MenuItem, openMenu } from "../ui/menu";
import type { Point } from "../ui/point";
import { type Happened, placesOfInstances, type Segment } from "./happened";
import type { Moment } from "./looking";

export class Visits {
  /** `look` shows a moment, and resolves to whether it is shown. */
  constructor(
    private readonly lab: Lab,
    private readonly happened: () => Happened,
    private readonly look: (moment: Moment) => Promise<boolean>,
  ) {}

  /** Open a menu about visits that last at a time. */
  open(at: Point, visits: readonly Segment[], time: number, title: string): void {
    const items = visits.flatMap((visit) => [null, ...this.itemsOf(visit, time, at)]);
    openMenu(this.lab.root, at, items.slice(1), title);
  }

  private itemsOf(visit: Segment, time: number, at: Point): MenuItem[] {
    const { state, by, tick } = visit;
    const name = this.nameOf(visit);
    const next = this.happened().after(visit);
    return [
      item(`Why ${name}?`, "why-visit", () => void this.whyState(visit, time, at)),
      item(`Why was ${name} entered?`, "why-begin", () => void this.whyFired(visit, at), { disabled: !by }),
      item(`Why was ${name} left?`, "why-end", () => next && void this.whyFired(next, at), {
        disabled: !next?.by,
      }),
      item(`Look at the entry of ${name}`, "look", () => void this.look({ tick })),
      item(`Go to the source of ${name}`, "source", () => this.lab.goTo("state", state)),
    ];
  }

  /** The name of a state; where its machine had several instances, with the place of this one. */
  nameOf({ state, lane }: Segment): string {
    const place = placesOfInstances(this.happened().lanes()).get(lane);
    return place ? `${nameOf(state)} in ${place}` : nameOf(state);
  }

  /** The instance to ask about, if its machine had several. */
  private askedIn(instance: string): string {
    return placesOfInstances(this.happened().lanes()).get(instance) ? instance : "";
  }

  private async whyState({ state, lane }: Segment, time: number, at: Point): Promise<void> {
    if (await this.look({ time })) askWhy(this.lab, "state", state, at, this.askedIn(lane));
  }

  /** Ask why the transition fired with which a visit began. */
  async whyFired(visit: Segment, at: Point): Promise<void> {
    const { tick, by } = visit;
    const instance = this.askedIn(this.happened().leader(visit));
    if (await this.look({ tick })) askWhy(this.lab, "transition", by, at, instance);
  }
}
