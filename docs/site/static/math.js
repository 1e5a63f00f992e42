// Sets the formulas that Sphinx leaves as \( \) and \[ \].
addEventListener("load", function () {
    document.querySelectorAll("span.math, div.math").forEach(function (element) {
        var text = element.textContent.trim().replace(/^\\[(\[]/, "").replace(/\\[)\]]$/, "");
        katex.render(text, element, {displayMode: element.tagName == "DIV", throwOnError: false});
    });
});
