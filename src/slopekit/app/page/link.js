/* The socket: questions with answers, and events. Nothing else goes anywhere. */

const listeners = {};
const waiting = new Map();
let socket = null;
let number = 0;
let tries = 0;

/** Hear events: "hello", "design", "answer", "progress", "done", "up", "down", and whatever the page tells itself. */
export function on(name, act) {
  (listeners[name] = listeners[name] || []).push(act);
}

export function tell(name, data) {
  for (const act of listeners[name] || []) { act(data); }
}

/** Ask the server; the promise holds its message, faults included. */
export function ask(verb, given = {}) {
  if (!socket || socket.readyState !== WebSocket.OPEN) {
    return Promise.resolve({ of: verb, lost: true, faults: [{ message: "slopekit does not answer: it was stopped, or is starting.", advice: "" }] });
  }
  number += 1;
  const id = number;
  socket.send(JSON.stringify({ ...given, id, do: verb }));
  return new Promise((done) => { waiting.set(id, done); });
}

export function connect() {
  const address = new URL("link", location.href);
  address.protocol = "ws:";
  socket = new WebSocket(address.href);
  socket.addEventListener("open", () => { tries = 0; tell("up"); });
  socket.addEventListener("message", (event) => { heard(JSON.parse(event.data)); });
  socket.addEventListener("close", () => {
    for (const done of waiting.values()) { done({ lost: true, faults: [{ message: "The connection was lost.", advice: "" }] }); }
    waiting.clear();
    tell("down");
    tries += 1;
    if (tries < 40) { window.setTimeout(connect, Math.min(400 * tries, 5000)); }
  });
}

function heard(message) {
  const done = waiting.get(message.id);
  if (message.fos) {
    if (!done && message.values) { tell("touched", message.values); tell("values", message.values); }  // by another page
    tell("answer", message);
  }
  else if (!done) { tell(message.of, message); }
  if (done) {
    waiting.delete(message.id);
    done(message);
  }
}
