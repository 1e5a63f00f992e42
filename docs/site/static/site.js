// A button on each block of code that copies it.
addEventListener("DOMContentLoaded", function () {
    document.querySelectorAll("article div.highlight").forEach(function (block) {
        var button = document.createElement("button");
        button.className = "copy";
        button.textContent = "copy";
        button.addEventListener("click", function () {
            copy(block.querySelector("pre").textContent);
            button.textContent = "copied";
            setTimeout(function () { button.textContent = "copy"; }, 1500);
        });
        block.append(button);
    });
    function copy(text) {
        if (navigator.clipboard) return navigator.clipboard.writeText(text).catch(function () { byHand(text); });
        byHand(text);
    }
    function byHand(text) { // a page from file:// may have no clipboard
        var area = document.createElement("textarea");
        area.value = text;
        document.body.append(area);
        area.select();
        document.execCommand("copy");
        area.remove();
    }
});
