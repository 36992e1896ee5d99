/** The forms of the language: what completion inserts, where each belongs, and what it means. */

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

function form(template: string, detail: string, inside: string, usage: string, doc: string): Form {
  return { template, detail, inside, usage, doc };
}

export const FORMS: Record<string, Form> = {
  var: form(
    "var #{name} := [#{value}]",
    "a variable",
    "Program Machine Spawn",
    "(var name := [value])",
    "A variable. At the top level it gets its value when the program starts; in a machine, whenever the machine is spawned. In a `spawn` it gives a variable of that machine another value for this use.",
  ),
  machine: form(
    "machine #{name}\n\t#{}",
    "states and transitions",
    "Program State",
    "(machine name …)",
    "A state machine: variables, events, states and transitions. It runs once it is spawned, and exactly one of its states is active.",
  ),
  state: form(
    "state #{name}#{}",
    "a state",
    "Machine",
    "(state name …)",
    "A state with its actions: `onentry`, `running`, `onexit`. Machines inside it run only while it is active.",
  ),
  event: form(
    "event #{name} [#{condition}]",
    "a condition with a name",
    "Program Machine",
    "(event name [condition])",
    "A condition with a name. It occurs when its Python is `True`; it is tested only where an `on` or `exit` waits for it.",
  ),
  spawn: form(
    "spawn #{machine} #{state}",
    "start a machine",
    "Program Action",
    "(spawn machine state)",
    "Starts a machine in a state: at the top level when the program starts, in `onentry` when the state is entered. `(var name := [value])` after the state initialises a variable of the machine for this use.",
  ),
  onentry: form(
    "onentry [#{}]",
    "once, on entering",
    "State",
    "(onentry [action])",
    "Runs once, when the state is entered.",
  ),
  running: form(
    "running [#{}]",
    "at every tick",
    "State",
    "(running [action])",
    "Runs at every tick while the state is active, from that of its entry on.",
  ),
  onexit: form(
    "onexit [#{}]",
    "once, on leaving",
    "State",
    "(onexit [action])",
    "Runs once, when the state is left.",
  ),
  on: form(
    "on #{event} #{source} -> #{destination}",
    "when an event occurs",
    "Machine",
    "(on event source -> destination)",
    "Leads to another state as soon as an event occurs. The event can also be a condition: `[robot.bumper.data == 1]`, or the state of a machine that the source spawned: `move.reached`. The source `*` means every other state.",
  ),
  ontime: form(
    "ontime #{milliseconds} #{source} -> #{destination}",
    "after milliseconds",
    "Machine",
    "(ontime milliseconds source -> destination)",
    "Leads to another state when the source has been active for so many milliseconds: a number, a variable, or Python in brackets.",
  ),
  eps: form(
    "eps #{source} -> #{destination}",
    "at once",
    "Machine",
    "(eps source -> destination)",
    "Leads to another state without waiting: in the tick after the source was entered. The source does not act.",
  ),
  exit: form(
    "exit #{event} #{source} -> #{destination}",
    "out of the nested machine",
    "Machine",
    "(exit event source -> destination)",
    "Leaves a nested machine: the destination is a state of the machine around it.",
  ),
  for: form(
    "for #{milliseconds}",
    "only if it holds for so long",
    "",
    "(on event for milliseconds source -> destination)",
    "The event must hold for so many milliseconds without a break: a number, a variable, or Python in brackets. The count begins when the source is entered, at the earliest.",
  ),
  effect: form(
    "effect [#{}]",
    "when the transition fires",
    "Transition",
    "(effect [action])",
    "Runs when the transition fires, before its source is left: the machines in the source still have their values.",
  ),
  onpause: form(
    "onpause [#{}]",
    "when paused",
    "Program",
    "(onpause [action])",
    "Runs when the program is paused.",
  ),
  onresume: form(
    "onresume [#{}]",
    "when resumed",
    "Program",
    "(onresume [action])",
    "Runs when the program resumes.",
  ),
  onend: form(
    "onend [#{}]",
    "at the end of the run",
    "Program",
    "(onend [action])",
    "Runs once when the run ends: when it is reset, stopped or closed. The robot stands before and after that.",
  ),
};
