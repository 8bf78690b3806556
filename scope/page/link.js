// The socket to the server: connects again by itself, and says that the page lives.

const TOKEN = document.querySelector("meta[name=token]").content;
const ALIVE_MS = 100, AGAIN_MS = 500;

function connect(handlers) {
  const link = { socket: null, commands: false, isOpen: false };
  link.send = (order) => {
    // A socket that does not keep up gets no more: what it holds would come too late.
    if (!link.isOpen || link.socket.bufferedAmount > 65536) return;
    const { do: name, ...fields } = order;
    link.socket.send(JSON.stringify(Object.keys(fields).length ? { [name]: fields } : name));
  };
  link.join = () => link.send({ do: "join", token: TOKEN });
  const open = () => {
    const socket = new WebSocket(`ws://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    link.socket = socket;
    socket.onopen = () => { link.isOpen = true; link.join(); handlers.opened(); };
    socket.onmessage = ({ data }) => {
      if (typeof data !== "string") { handlers.rows(data); return; }
      const message = JSON.parse(data);
      if (message.type === "role") link.commands = message.commands;
      handlers[message.type]?.(message);
    };
    socket.onclose = () => {
      const was = link.isOpen;
      link.isOpen = link.commands = false;
      handlers.closed(was);
      setTimeout(open, AGAIN_MS);
    };
  };
  // The board goes safe when these stop: with the page, or when it freezes.
  setInterval(() => { if (link.commands) link.send({ do: "alive" }); }, ALIVE_MS);
  open();
  return link;
}
