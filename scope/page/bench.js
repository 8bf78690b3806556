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
      input.min = shortest(setting.least); input.max = shortest(setting.most); input.step = setting.whole ? 1 : "any";
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

  status({ settings, stored, guide, undoes, on }) {
    this.guided = guide?.runs === true;
    this.inputs.forEach((input, number) => {
      const value = settings?.[number];
      input.disabled = value === undefined;
      if (value !== undefined && !this.edited.has(number)) {
        const text = shortest(value);
        if (input.value !== text) input.value = text;
      }
    });
    // The settings of an ended procedure are undone first.
    $("store").disabled = !settings || on || this.guided || undoes;
    for (const button of $("guides").children) button.disabled = this.guided || undoes;
    setText("stored", stored && !guide?.runs ? sentence(stored.words) : "");
    if (!guide) return setText("guide", "");
    const end = guide.runs ? "\u2026" : guide.failure ? `FAIL  ${guide.failure}` : "done";
    // The columns of a terminal are too wide here.
    const lines = guide.lines.map((line) => line.replace(/ {2,}/g, "  "));
    setText("guide", [guide.name, ...lines, end].join("\n"));
  }
}

// The shortest text of an f32 that is read as the same f32.
function shortest(value) {
  for (let digits = 1; ; digits++) {
    const text = String(Number(value.toPrecision(digits)));
    if (digits === 9 || Math.fround(Number(text)) === value) return text;
  }
}

function sentence(text) { return `${text[0].toUpperCase()}${text.slice(1)}.`; }
