// A picture without a frame buffer, the other way: the spans of a mesh from a table, which `quad-cosine` walks ahead of the beam.
//
// The table has a span a line in the order of the beam, as examples/video/mesh.py computes them. The core gives a point a clock,
// which waits in its wrapper until the beam is there; the wrapper's buffer takes 256 of them.

`default_nettype none

/* verilator lint_off DECLFILENAME */
module video (
    input  wire       clk,      // of a pixel
    input  wire       rst_n,
    output reg        hsync,
    output reg        vsync,
    output reg        visible,
    output reg  [7:0] red,      // 0 where nothing is visible
    output reg  [7:0] green,
    output reg  [7:0] blue
);

    wire [9:0] column;
    wire [9:0] row;
    wire [2:0] signals;
    wire       line_end;
    wire       frame_end;
    beam beam (
        .clk(clk),
        .rst_n(rst_n),
        .column(column),
        .row(row),
        .hsync(signals[2]),
        .vsync(signals[1]),
        .visible(signals[0]),
        .line_end(line_end),
        .frame_end(frame_end)
    );

    // Below the picture everything begins anew, 24 lines ahead of the first.
    reg again;
    always @(posedge clk) again <= ~rst_n | (row == 10'd500);

    // The table: row, column, colour, amplitude, length, zeta_start and delta_zeta, both s1.18 in right angles.
    reg [82:0] spans [0:4095];
    initial $readmemh("spans.mem", spans);
    reg [11:0] at;
    reg [82:0] span;
    reg        fetching;
    reg        offered;
    wire       accepted;
    always @(posedge clk) begin
        if (!offered) span <= spans[at];
    end
    always @(posedge clk) begin
        if (again) begin
            at <= 12'd0;
            fetching <= 1'b0;
            offered <= 1'b0;
        end else if (offered) begin
            if (accepted) offered <= 1'b0;
        end else begin
            fetching <= ~fetching;
            if (fetching) begin
                offered <= 1'b1;
                at <= at + 12'd1;
            end
        end
    end

    wire [7:0]  amplitude = span[55:48];
    wire [7:0]  length = span[47:40];
    wire [27:0] zeta_start = {span[39:20], 8'd0};
    wire [27:0] delta_zeta = {span[19:0], 8'd0};

    // Points, each with the row and the column where its span begins, and its colour without the highlight.
    wire        there;
    wire        last;
    wire [7:0]  shine;
    wire [8:0]  begin_row;
    wire [9:0]  begin_column;
    wire [7:0]  base;
    wire        take;
    spans_axis core (
        .aclk(clk),
        .aresetn(~again),
        .s_axis_tdata({6'd0, 10'd60, length, 4'd0, zeta_start, 4'd0, delta_zeta, amplitude}),
        .s_axis_tuser(span[82:56]),
        .s_axis_tvalid(offered),
        .s_axis_tready(accepted),
        .m_axis_tdata(shine),
        .m_axis_tuser({begin_row, begin_column, base}),
        .m_axis_tlast(last),
        .m_axis_tvalid(there),
        .m_axis_tready(take)
    );

    // A span is taken from the place where it begins to its end, a point a clock.
    reg  within_span;
    wire begins = column == begin_column && row == {1'b0, begin_row};
    assign take = there & signals[0] & (within_span | begins);
    always @(posedge clk) within_span <= ~again & (take ? ~last : within_span);

    // The colour of a pixel without its highlight: gold where there is a span.
    reg [2:0] signals_1;
    reg [7:0] red_1;
    reg [7:0] green_1;
    reg [7:0] blue_1;
    reg [7:0] shine_1;
    wire [9:0] thrice = {2'd0, base} + {1'b0, base, 1'b0};
    always @(posedge clk) begin
        signals_1 <= rst_n ? signals : 3'b110;
        red_1 <= take ? base : 8'd13;
        green_1 <= take ? thrice[9:2] : 8'd15;
        blue_1 <= take ? {2'd0, base[7:2]} : 8'd20;
        shine_1 <= take ? shine : 8'd0;
    end

    function [7:0] sum(input [7:0] a, input [7:0] b);
        reg [8:0] both;
        begin
            both = {1'b0, a} + {1'b0, b};
            sum = both[8] ? 8'd255 : both[7:0];
        end
    endfunction

    wire seen = signals_1[0];
    always @(posedge clk) begin
        hsync <= signals_1[2];
        vsync <= signals_1[1];
        visible <= seen;
        red <= seen ? sum(red_1, shine_1) : 8'd0;
        green <= seen ? sum(green_1, shine_1) : 8'd0;
        blue <= seen ? sum(blue_1, shine_1) : 8'd0;
    end

    wire unused = &{1'b0, line_end, frame_end, thrice[1:0]};
endmodule

`default_nettype wire
