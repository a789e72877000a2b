// Texts that are cut, beside the window, over the edge of their card, or drawn over each other. It sees texts of elements,
// not those in fields. Of texts that the window does not show, it sees only whether they are cut. A list that scrolls may
// hide its rows.
(() => {
    const found = new Set();
    const texts = [];
    const range = document.createRange();
    // What wraps out of sight where there is no room stands elsewhere too: the motor of a title in the strip, the ID of a
    // wheel in the drawing.
    const exempt = '.graph-head h2 span, .read-out-name .motor-title, .rover-card b > :last-child, script, style, option, [inert]';
    // Rows of the log are drawn up to the edge of their list.
    const mayBeCut = '.packet-window';
    // Only screen readers find it.
    const isClipped = (style) => style.clipPath !== 'none' || style.clip !== 'auto';
    const isUnpainted = (element) => {
        const { fill } = getComputedStyle(element);
        return element instanceof SVGElement && (fill === 'none' || fill.endsWith(', 0)'));
    };

    /** The part of a box that its places let through, and the first place that cuts it. */
    const shown = (element, box) => {
        const lead = box.height * 0.2;
        const part = { left: box.left, right: box.right, top: box.top + lead, bottom: box.bottom - lead };
        let cutter = null;
        for (let place = element; place && place !== document.body; place = place.parentElement) {
            const style = getComputedStyle(place);
            if (isClipped(style)) return null;
            if (style.display === 'contents') continue;
            const inner = place.getBoundingClientRect();
            for (const [overflow, from, to] of [['overflowX', 'left', 'right'], ['overflowY', 'top', 'bottom']]) {
                if (style[overflow] === 'visible') continue;
                const isOver = part[from] < inner[from] - 1 || part[to] > inner[to] + 1;
                const scrolls = ['auto', 'scroll'].includes(style[overflow]);
                // What a list has scrolled away is not cut.
                if (scrolls && isOver && (part[to] <= inner[from] || part[from] >= inner[to])) return null;
                if (!scrolls && isOver) cutter ??= place;
                part[from] = Math.max(part[from], inner[from]);
                part[to] = Math.min(part[to], inner[to]);
            }
            if (style.position === 'fixed') break;
        }
        return { ...part, cutter };
    };

    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node; (node = walker.nextNode());) {
        const words = node.data.trim().replace(/\s+/g, ' ').slice(0, 40);
        const element = node.parentElement;
        if (!words || element.closest(exempt) || isUnpainted(element)) continue;
        if (!element.getClientRects().length || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
        range.selectNodeContents(node);
        for (const box of range.getClientRects()) {
            const part = box.width && shown(element, box);
            if (!part) continue;
            if (part.cutter && !element.closest(mayBeCut)) found.add(`cut: ${words}, in ${part.cutter.getAttribute('class') ?? part.cutter.localName}`);
            if (part.bottom <= part.top || part.right <= part.left) continue;
            if (part.right > innerWidth + 1 || part.left < -1) found.add(`beside the window: ${words}`);
            const card = element.closest('.panel, .rover-card, .button')?.getBoundingClientRect();
            if (card && (part.right > card.right + 1 || part.left < card.left - 1)) found.add(`over the edge: ${words}`);
            if (part.bottom < 0 || part.top > innerHeight) continue;
            texts.push({ node, element, words, ...part });
        }
    }

    const isOpaque = (element) => {
        const { backgroundColor, backgroundImage } = getComputedStyle(element);
        const alpha = /(?:rgba\(.*,|\/) ?([\d.]+)\)/.exec(backgroundColor);
        return backgroundImage !== 'none' || !alpha || Number(alpha[1]) > 0.5;
    };
    /** Whether nothing opaque lies over a text at a point. */
    const isSeen = (text, x, y) => {
        for (const element of document.elementsFromPoint(x, y)) {
            if (element.contains(text.element) || text.element.contains(element)) return true;
            if (!(element instanceof SVGElement) && isOpaque(element)) return false;
        }
        return true;
    };
    // Else the texts that take no click are not found at a point.
    const clickable = new CSSStyleSheet();
    clickable.replaceSync('* { pointer-events: auto !important; }');
    document.adoptedStyleSheets.push(clickable);
    for (const [at, one] of texts.entries()) {
        for (const two of texts.slice(at + 1)) {
            if (one.node === two.node) continue;
            const [left, right] = [Math.max(one.left, two.left), Math.min(one.right, two.right)];
            const [top, bottom] = [Math.max(one.top, two.top), Math.min(one.bottom, two.bottom)];
            if (right - left < 1.5 || bottom - top < 1.5) continue;
            const [x, y] = [(left + right) / 2, (top + bottom) / 2];
            if (isSeen(one, x, y) && isSeen(two, x, y)) found.add(`over each other: ${one.words}, ${two.words}`);
        }
    }
    document.adoptedStyleSheets.pop();
    return [...found];
})()
