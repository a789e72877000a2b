// How long the browser takes to lay out the page after a change of one element, the worst of 16 that are spread over the
// desk, and after a change that concerns all texts of the desk.
(() => {
    const places = 16;
    const changes = 20;
    const layoutMs = (element, property) => {
        const before = performance.now();
        for (let change = 0; change < changes; change++) {
            element.style.setProperty(property, change % 2 ? "0.1px" : "0.2px");
            document.body.getBoundingClientRect();
        }
        const ms = (performance.now() - before) / changes;
        element.style.removeProperty(property);
        document.body.getBoundingClientRect();
        return ms;
    };
    const desk = document.getElementById("control");
    const shown = [...desk.querySelectorAll("*")].filter(
        element => element.offsetWidth && !element.children.length && element.textContent.trim());
    const chosen = Array.from({ length: places }, (_, place) => shown[Math.floor((place + 0.5) * shown.length / places)]);
    return {
        one: Math.max(...chosen.map(element => layoutMs(element, "padding-bottom"))),
        all: layoutMs(desk, "letter-spacing"),
    };
})()
