// Settings of the board and guided procedures: made from the facts, filled from the status.

class Bench {
  constructor(facts, link) {
    Object.assign(this, { facts, link, edited: new Set() });
    $("bench-card").hidden = facts.source.kind === "recorded";
    this.makeSettings();
    const buttons = facts.guides.map((name) => {
      const button = document.createElement("button");
      button.type = "button"; button.textContent = name; button.dataset.guide = name;
      button.onclick = () => this.link.send({ do: "guide", name });
      return button;
    });
    $("guides").replaceChildren(...buttons);
    $("store").onclick = () => this.link.send({ do: "store" });
    $("bench-card").ontoggle = () => this.ask();
    // An answer may be lost, and another program may change a setting.
    setInterval(() => this.ask(), 1000);
  }

  ask() {
    if ($("bench-card").open && !$("bench").disabled && !this.guided) this.link.send({ do: "settings" });
  }

  makeSettings() {
    this.inputs = this.facts.settings.map((setting, number) => {
      const input = document.createElement("input");
      input.type = "number"; input.id = `setting-${setting.name}`; input.title = setting.meaning;
      input.min = setting.least; input.max = setting.most; input.step = setting.whole ? 1 : "any";
      input.disabled = true;
      input.oninput = () => this.edited.add(number);
      input.onchange = () => {
        if (input.value !== "" && !input.reportValidity()) return;
        this.edited.delete(number);
        if (input.value === "") return;
        this.link.send({ do: "set", setting: number, value: Number(input.value) });
        this.ask();
      };
      return input;
    });
    $("settings").replaceChildren(...this.facts.settings.map((setting, number) => {
      const label = document.createElement("label"), name = document.createElement("span"), unit = document.createElement("span");
      label.title = setting.meaning; name.textContent = setting.name; unit.textContent = setting.unit; unit.className = "small";
      label.append(name, this.inputs[number], unit);
      return label;
    }));
  }

  status({ settings, stored, guide, on }) {
    this.guided = guide?.runs === true;
    this.inputs.forEach((input, number) => {
      const value = settings?.[number];
      input.disabled = value === undefined;
      if (value !== undefined && !this.edited.has(number)) {
        // The shortest text of an f32.
        const text = String(Number(value.toPrecision(7)));
        if (input.value !== text) input.value = text;
      }
    });
    $("store").disabled = !settings || on || this.guided;
    for (const button of $("guides").children) button.disabled = this.guided;
    setText("stored", stored && !guide?.runs ? sentence(stored.words) : "");
    if (!guide) return setText("guide", "");
    const end = guide.runs ? "\u2026" : guide.failure ? `FAIL  ${guide.failure}` : "done";
    setText("guide", [guide.name, ...guide.lines, end].join("\n"));
  }
}

function sentence(text) { return `${text[0].toUpperCase()}${text.slice(1)}.`; }
