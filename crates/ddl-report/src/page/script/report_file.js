// The embedded report as a file.

document.getElementById("save-report").addEventListener("click", () => {
  const text = document.getElementById("report-json").textContent;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  link.download = "report.json";
  link.click();
  // The browser reads the address after this event.
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
});
