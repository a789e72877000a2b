// The rows of the robots. Everything that a robot has said is text, never markup.
"use strict";

const LANGUAGES = ["en", "de", "zh"];
const language = navigator.languages.map((tag) => tag.slice(0, 2).toLowerCase()).find((tag) => LANGUAGES.includes(tag)) ?? "en";
const rows = new Map();
const robots = document.getElementById("robots");
const filter = document.getElementById("filter");
let words = {};

const word = (key, values = {}) =>
  (words[key] ?? key.replaceAll("_", " ")).replace(/\{(\w+)\}/g, (_, name) => values[name]);

const number = (value, digits) =>
  value.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits });

/** Changes only what differs: a selection and the focus stay. */
const show = (element, text) => {
  if (element.textContent !== text) element.textContent = text;
};

const say_trouble = (text) => show(document.getElementById("trouble"), text);

const age = (ms) => {
  if (ms === undefined) return word("never_heard");
  return ms < 1000 ? word("gone") : word("not_heard", { seconds: number(ms / 1000, 0) });
};

const state_of = ({ heard, age_ms, state }) => {
  if (!heard) return age(age_ms);
  const { connected, port_open } = state.link;
  if (!connected) return word("no_connection");
  if (port_open === false) return word("no_port");
  const { is, why, must_rest } = state.drive;
  // Why it does not drive says nothing while others drive it.
  const has_reason = is === "stopped" || is === "not_confirmed";
  const first = has_reason && why ? `${word(is)}: ${word(why)}` : word(is);
  return must_rest && is === "stopped" ? `${first}. ${word("must_rest")}` : first;
};

/** Without a connection to motorlink it is not known. */
const control_of = (control) => (control ? word(control.by, { number: control.number ?? "" }) : "");

const problem_of = (motor) => {
  const found = [];
  if (motor.faults) found.push(word("faults", { bits: `0x${motor.faults.toString(16).padStart(2, "0")}` }));
  if (motor.reply_age_ms === undefined) found.push(word("no_reply_yet"));
  if (motor.silent) found.push(word("motor_silent"));
  if (motor.may_turn && motor.activity === "idle") found.push(word("may_turn"));
  if (motor.turns_unasked) found.push(word("turns_unasked"));
  return found.length ? [`${word("motor", { id: motor.id })}: ${found.join(", ")}`] : [];
};

/** Only addresses of pages: a robot may say anything. */
const page_of = (state) => {
  try {
    const url = new URL(state?.page);
    return url.protocol === "http:" || url.protocol === "https:" ? url.href : "";
  } catch {
    return "";
  }
};

const new_row = () => {
  const row = document.createElement("tr");
  const cell = (tag, name) => {
    const element = row.appendChild(document.createElement(tag));
    element.className = name;
    return element;
  };
  const name = cell("th", "name");
  name.scope = "row";
  const cells = { row, name, state: cell("td", "state"), control: cell("td", "control") };
  cells.motors = cell("td", "number");
  cells.hottest = cell("td", "number");
  cells.problem = cell("td", "problem");
  for (const key of ["control", "motors", "hottest"]) cells[key].dataset.name = word(key);
  return cells;
};

const show_name = (cells, name, page) => {
  const link = cells.name.querySelector("a");
  if (!page) {
    if (link) cells.name.replaceChildren(name);
    return show(cells.name, name);
  }
  if (link?.href === page) return;
  const made = document.createElement("a");
  Object.assign(made, { href: page, target: "_blank", rel: "noreferrer", textContent: name });
  made.title = word("open", { name });
  cells.name.replaceChildren(made);
};

const fill = (cells, robot) => {
  const { state, heard, name } = robot;
  const motors = state?.motors ?? [];
  const degrees = motors.map((motor) => motor.temperature_c).filter(Number.isFinite);
  const level = heard ? state.level : "lost";
  if (cells.row.dataset.level !== level) cells.row.dataset.level = level;
  show_name(cells, name, page_of(state));
  show(cells.state, state_of(robot));
  show(cells.control, heard ? control_of(state.control) : "");
  show(cells.motors, heard ? number(motors.length, 0) : "");
  show(cells.hottest, degrees.length ? `${number(Math.max(...degrees), 0)} °C` : "");
  // Without a connection, nothing is known of any motor: the state says so.
  show(cells.problem, state?.link.connected ? motors.flatMap(problem_of).join("; ") : "");
};

const show_robots = ({ robots: all, router }) => {
  const wanted = filter.value.trim().toLowerCase();
  const shown = new Set();
  let last = null;
  for (const robot of all.filter(({ name }) => name.toLowerCase().includes(wanted))) {
    const key = `${robot.name} ${robot.session}`;
    const cells = rows.get(key) ?? new_row();
    rows.set(key, cells);
    shown.add(key);
    fill(cells, robot);
    const after = last ? last.nextSibling : robots.firstChild;
    if (after !== cells.row) robots.insertBefore(cells.row, after);
    last = cells.row;
  }
  for (const [key, { row }] of rows) {
    if (!shown.has(key)) {
      row.remove();
      rows.delete(key);
    }
  }
  const count = (is) => number(all.filter(is).length, 0);
  show(document.getElementById("counts"), word("counts", {
    all: number(all.length, 0),
    driving: count(({ state }) => ["drives", "driven_by_other"].includes(state?.drive.is)),
    problems: count(({ state }) => state && state.level !== "ok"),
    lost: count(({ heard }) => !heard),
  }));
  if (!router) say_trouble(word("no_router"));
  else say_trouble(all.length ? "" : word("no_robots"));
};

/** The newest answer, for the filter. */
let newest = null;

const load = async () => {
  const answer = await fetch("/fleet/state", { signal: AbortSignal.timeout(1500) });
  if (!answer.ok) throw new Error(String(answer.status));
  newest = await answer.json();
  show_robots(newest);
};

const forget = () => {
  newest = null;
  robots.replaceChildren();
  rows.clear();
  show(document.getElementById("counts"), "");
};

const REASONS = { 401: "no_access", 503: "no_program" };

/** Without an answer, the old rows would look like the robots of now. */
const lose = (error) => {
  forget();
  say_trouble(word(REASONS[error.message] ?? "no_server"));
};

/** One question at a time: an older answer comes behind no newer one. */
const turn = async () => {
  if (!document.hidden) await load().catch(lose);
  setTimeout(turn, 1000);
};

const start = async () => {
  const all = await (await fetch("/fleet/words.json")).json();
  words = all[language];
  document.documentElement.lang = language;
  document.title = `${word("fleet")} · MotorLink`;
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  filter.addEventListener("input", () => newest && show_robots(newest));
  // A hidden page asks nothing: its rows are old when it is shown again.
  document.addEventListener("visibilitychange", () => document.hidden && forget());
  turn();
};

start().catch(() => setTimeout(() => location.reload(), 3000));
