// The beam of 640x480 at 60 Hz: 800 clocks a line, 525 lines a frame, both syncs low while active.
//
// Timing: VESA's DMT 04h. What is visible comes first in a line and in a frame.

`default_nettype none

module beam (
    input  wire       clk,
    input  wire       rst_n,
    output reg  [9:0] column,
    output reg  [9:0] row,
    output wire       hsync,
    output wire       vsync,
    output wire       visible,
    output wire       line_end,   // the last clock of a line
    output wire       frame_end   // the last clock of a frame
);

    assign hsync = ~(column >= 10'd656 && column < 10'd752);
    assign vsync = ~(row >= 10'd490 && row < 10'd492);
    assign visible = column < 10'd640 && row < 10'd480;
    assign line_end = column == 10'd799;
    assign frame_end = line_end && row == 10'd524;

    always @(posedge clk) begin
        if (!rst_n) begin
            column <= 10'd0;
            row <= 10'd0;
        end else begin
            column <= line_end ? 10'd0 : column + 10'd1;
            if (line_end) row <= frame_end ? 10'd0 : row + 10'd1;
        end
    end
endmodule

`default_nettype wire
