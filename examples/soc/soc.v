// A system on a chip that shades: PicoRV32, 64 kB of RAM, and three devices of Glint. Two are there twice, so that both ways can
// be compared: a sequential core behind registers on Wishbone, and a pipeline between AXI4-Streams with a span engine, span.v.
// The third, lit, is a pipeline only. The processor calls the functions of a unit, sfu, by instructions.
//
//  0x0000_0000  RAM, with the program, the operands and the frame buffer
//  0x1000_0000  the registers of `shade`, cosine-power
//  0x2000_0000  +0 a byte of the picture of `shade`, +4 a number to print, +8 the end, with an exit code, +12 a byte of
//               the picture of `grain`, +16 one of the picture of `lit`
//  0x3000_0000  the registers of `grain`, rough
//  0x4000_0000  the span engine of `shade_pipeline`, cosine-power
//  0x5000_0000  the span engine of `grain_pipeline`, rough
//  0x6000_0000  the span engine of `lit`, an expression

`default_nettype none

module soc (
    input  wire        clk,
    input  wire        rst_n,
    output reg         shade_write,
    output reg         grain_write,
    output reg         lit_write,
    output reg         number_write,
    output reg         end_write,
    output reg  [31:0] written,
    output wire        failed           // a trap, or an access that a core does not know
);

    wire        mem_valid;
    wire        mem_ready;
    wire [31:0] mem_addr;
    wire [31:0] mem_wdata;
    wire [3:0]  mem_wstrb;
    wire [31:0] mem_rdata;
    wire        mem_la_read;
    wire        mem_la_write;
    wire [31:0] mem_la_addr;
    wire [31:0] mem_la_wdata;
    wire [3:0]  mem_la_wstrb;
    wire        trap;
    wire        pcpi_valid;
    wire [31:0] pcpi_insn;
    wire [31:0] pcpi_rs1;
    wire [31:0] pcpi_rs2;
    wire        pcpi_wr;
    wire [31:0] pcpi_rd;
    wire        pcpi_wait;
    wire        pcpi_ready;

    picorv32 #(
        .BARREL_SHIFTER(1),
        .ENABLE_FAST_MUL(1),
        .ENABLE_DIV(1),
        .ENABLE_PCPI(1),
        .STACKADDR(32'h0001_0000)
    ) processor (
        .clk(clk),
        .resetn(rst_n),
        .trap(trap),
        .mem_valid(mem_valid),
        .mem_instr(),
        .mem_ready(mem_ready),
        .mem_addr(mem_addr),
        .mem_wdata(mem_wdata),
        .mem_wstrb(mem_wstrb),
        .mem_rdata(mem_rdata),
        .mem_la_read(mem_la_read),
        .mem_la_write(mem_la_write),
        .mem_la_addr(mem_la_addr),
        .mem_la_wdata(mem_la_wdata),
        .mem_la_wstrb(mem_la_wstrb),
        .pcpi_valid(pcpi_valid),
        .pcpi_insn(pcpi_insn),
        .pcpi_rs1(pcpi_rs1),
        .pcpi_rs2(pcpi_rs2),
        .pcpi_wr(pcpi_wr),
        .pcpi_rd(pcpi_rd),
        .pcpi_wait(pcpi_wait),
        .pcpi_ready(pcpi_ready),
        .irq(32'd0),
        .eoi(),
        .trace_valid(),
        .trace_data()
    );

    // The unit of functions, which the processor calls by instructions.
    sfu_pcpi sfu (
        .clk(clk),
        .resetn(rst_n),
        .pcpi_valid(pcpi_valid),
        .pcpi_insn(pcpi_insn),
        .pcpi_rs1(pcpi_rs1),
        .pcpi_rs2(pcpi_rs2),
        .pcpi_wr(pcpi_wr),
        .pcpi_rd(pcpi_rd),
        .pcpi_wait(pcpi_wait),
        .pcpi_ready(pcpi_ready)
    );

    // RAM answers in the first clock of a request: it is asked a clock ahead. It has one port. The processor's requests go
    // first, and it never asks in two clocks one after another; the others are the span engines'.
    reg  [31:0] ram [0:16383];
    initial $readmemh("firmware.hex", ram);
    reg         ram_ready;
    reg  [31:0] ram_rdata;
    wire        la_ram = (mem_la_read | mem_la_write) & (mem_la_addr[31:28] == 4'd0);
    wire        shade_asks;
    wire        shade_writes;
    wire [15:2] shade_at;
    wire [31:0] shade_data;
    wire        grain_asks;
    wire        grain_writes;
    wire [15:2] grain_at;
    wire [31:0] grain_data;
    wire        lit_asks;
    wire        lit_writes;
    wire [15:2] lit_at;
    wire [31:0] lit_data;
    wire [15:2] ram_at = la_ram ? mem_la_addr[15:2] : shade_asks ? shade_at : grain_asks ? grain_at : lit_at;
    wire [31:0] ram_wdata = la_ram ? mem_la_wdata : shade_asks ? shade_data : grain_asks ? grain_data : lit_data;
    wire        span_writes = shade_asks ? shade_writes : grain_asks ? grain_writes : lit_asks & lit_writes;
    wire [3:0]  ram_wstrb = la_ram ? {4{mem_la_write}} & mem_la_wstrb : {4{span_writes}};
    always @(posedge clk) begin
        ram_ready <= rst_n & la_ram;
        ram_rdata <= ram[ram_at];
        if (ram_wstrb[0]) ram[ram_at][7:0] <= ram_wdata[7:0];
        if (ram_wstrb[1]) ram[ram_at][15:8] <= ram_wdata[15:8];
        if (ram_wstrb[2]) ram[ram_at][23:16] <= ram_wdata[23:16];
        if (ram_wstrb[3]) ram[ram_at][31:24] <= ram_wdata[31:24];
    end

    // The cores behind registers, which are asked a clock ahead too, and then until they answer.
    wire        la_any = mem_la_read | mem_la_write;
    wire        la_shade = la_any & (mem_la_addr[31:28] == 4'd1);
    wire        la_grain = la_any & (mem_la_addr[31:28] == 4'd3);
    wire        of_shade = mem_valid & (mem_addr[31:28] == 4'd1);
    wire        of_grain = mem_valid & (mem_addr[31:28] == 4'd3);
    wire        of_core = of_shade | of_grain;
    wire        core_we = of_core ? |mem_wstrb : mem_la_write;
    wire [5:0]  core_at = of_core ? mem_addr[5:0] : mem_la_addr[5:0];
    wire [31:0] core_wdata = of_core ? mem_wdata : mem_la_wdata;
    wire [3:0]  core_wstrb = of_core ? mem_wstrb : mem_la_wstrb;
    wire [31:0] shade_rdata;
    wire        shade_ack;
    wire        shade_err;
    shade_wb shade (
        .wb_clk_i(clk),
        .wb_rst_i(~rst_n),
        .wb_cyc_i(la_shade | of_shade),
        .wb_stb_i(la_shade | of_shade),
        .wb_we_i(core_we),
        .wb_adr_i(core_at),
        .wb_dat_i(core_wdata),
        .wb_sel_i(core_wstrb),
        .wb_dat_o(shade_rdata),
        .wb_ack_o(shade_ack),
        .wb_err_o(shade_err),
        .irq()
    );
    wire [31:0] grain_rdata;
    wire        grain_ack;
    wire        grain_err;
    grain_wb grain (
        .wb_clk_i(clk),
        .wb_rst_i(~rst_n),
        .wb_cyc_i(la_grain | of_grain),
        .wb_stb_i(la_grain | of_grain),
        .wb_we_i(core_we),
        .wb_adr_i(core_at),
        .wb_dat_i(core_wdata),
        .wb_sel_i(core_wstrb),
        .wb_dat_o(grain_rdata),
        .wb_ack_o(grain_ack),
        .wb_err_o(grain_err),
        .irq()
    );
    assign failed = trap | shade_err | grain_err;

    // The pipelines with their span engines.
    wire        shade_ready;
    wire [9:0]  shade_exponent;
    wire [23:0] shade_colour;
    wire [31:0] shade_operands;
    wire        shade_operands_last;
    wire        shade_operands_valid;
    wire        shade_operands_ready;
    wire [23:0] shade_result;
    wire        shade_result_last;
    wire        shade_result_valid;
    wire        shade_result_ready;
    span #(.WORDS(1)) shade_span (
        .clk(clk),
        .rst_n(rst_n),
        .request(mem_valid & (mem_addr[31:28] == 4'd4)),
        .write(|mem_wstrb),
        .at(mem_addr[4:2]),
        .data(mem_wdata),
        .ready(shade_ready),
        .ram_free(~la_ram),
        .ram_request(shade_asks),
        .ram_write(shade_writes),
        .ram_at(shade_at),
        .ram_data(shade_data),
        .ram_read_data(ram_rdata),
        .exponent(shade_exponent),
        .colour(shade_colour),
        .operands(shade_operands),
        .operands_last(shade_operands_last),
        .operands_valid(shade_operands_valid),
        .operands_ready(shade_operands_ready),
        .result(shade_result),
        .result_last(shade_result_last),
        .result_valid(shade_result_valid),
        .result_ready(shade_result_ready)
    );
    shade_pipeline_axis shade_pipeline (
        .aclk(clk),
        .aresetn(rst_n),
        .s_axis_tdata({shade_colour, 6'd0, shade_exponent, shade_operands[23:0]}),
        .s_axis_tuser(1'b0),
        .s_axis_tlast(shade_operands_last),
        .s_axis_tvalid(shade_operands_valid),
        .s_axis_tready(shade_operands_ready),
        .m_axis_tdata(shade_result),
        .m_axis_tuser(),
        .m_axis_tlast(shade_result_last),
        .m_axis_tvalid(shade_result_valid),
        .m_axis_tready(shade_result_ready)
    );
    wire        grain_ready;
    wire [9:0]  grain_exponent;
    wire [23:0] grain_colour;
    wire [63:0] grain_operands;     // cos gamma; cos dgamma, with the sign of dgamma in the highest bit
    wire        grain_operands_last;
    wire        grain_operands_valid;
    wire        grain_operands_ready;
    wire [23:0] grain_result;
    wire        grain_result_last;
    wire        grain_result_valid;
    wire        grain_result_ready;
    span #(.WORDS(2)) grain_span (
        .clk(clk),
        .rst_n(rst_n),
        .request(mem_valid & (mem_addr[31:28] == 4'd5)),
        .write(|mem_wstrb),
        .at(mem_addr[4:2]),
        .data(mem_wdata),
        .ready(grain_ready),
        .ram_free(~la_ram & ~shade_asks),
        .ram_request(grain_asks),
        .ram_write(grain_writes),
        .ram_at(grain_at),
        .ram_data(grain_data),
        .ram_read_data(ram_rdata),
        .exponent(grain_exponent),
        .colour(grain_colour),
        .operands(grain_operands),
        .operands_last(grain_operands_last),
        .operands_valid(grain_operands_valid),
        .operands_ready(grain_operands_ready),
        .result(grain_result),
        .result_last(grain_result_last),
        .result_valid(grain_result_valid),
        .result_ready(grain_result_ready)
    );
    grain_pipeline_axis grain_pipeline (
        .aclk(clk),
        .aresetn(rst_n),
        .s_axis_tdata({grain_colour, 7'd0, grain_operands[63], 6'd0, grain_exponent, grain_operands[55:32],
                       grain_operands[23:0]}),
        .s_axis_tuser(1'b0),
        .s_axis_tlast(grain_operands_last),
        .s_axis_tvalid(grain_operands_valid),
        .s_axis_tready(grain_operands_ready),
        .m_axis_tdata(grain_result),
        .m_axis_tuser(),
        .m_axis_tlast(grain_result_last),
        .m_axis_tvalid(grain_result_valid),
        .m_axis_tready(grain_result_ready)
    );

    wire        lit_ready;
    wire [9:0]  lit_exponent;
    wire [23:0] lit_colour;
    wire [31:0] lit_operands;       // the normal: x, y and z, 10 bits each
    wire        lit_operands_last;
    wire        lit_operands_valid;
    wire        lit_operands_ready;
    wire [23:0] lit_result;
    wire        lit_result_last;
    wire        lit_result_valid;
    wire        lit_result_ready;
    span #(.WORDS(1)) lit_span (
        .clk(clk),
        .rst_n(rst_n),
        .request(mem_valid & (mem_addr[31:28] == 4'd6)),
        .write(|mem_wstrb),
        .at(mem_addr[4:2]),
        .data(mem_wdata),
        .ready(lit_ready),
        .ram_free(~la_ram & ~shade_asks & ~grain_asks),
        .ram_request(lit_asks),
        .ram_write(lit_writes),
        .ram_at(lit_at),
        .ram_data(lit_data),
        .ram_read_data(ram_rdata),
        .exponent(lit_exponent),
        .colour(lit_colour),
        .operands(lit_operands),
        .operands_last(lit_operands_last),
        .operands_valid(lit_operands_valid),
        .operands_ready(lit_operands_ready),
        .result(lit_result),
        .result_last(lit_result_last),
        .result_valid(lit_result_valid),
        .result_ready(lit_result_ready)
    );
    lit_axis lit (
        .aclk(clk),
        .aresetn(rst_n),
        .s_axis_tdata({lit_colour, lit_exponent[7:0], 6'd0, lit_operands[29:20], 6'd0, lit_operands[19:10], 6'd0,
                       lit_operands[9:0]}),
        .s_axis_tuser(1'b0),
        .s_axis_tlast(lit_operands_last),
        .s_axis_tvalid(lit_operands_valid),
        .s_axis_tready(lit_operands_ready),
        .m_axis_tdata(lit_result),
        .m_axis_tuser(),
        .m_axis_tlast(lit_result_last),
        .m_axis_tvalid(lit_result_valid),
        .m_axis_tready(lit_result_ready)
    );

    // To the outside.
    wire of_console = mem_valid & (mem_addr[31:28] == 4'd2) & ~console_ready;
    reg  console_ready;
    always @(posedge clk) begin
        console_ready <= rst_n & of_console;
        shade_write <= of_console & (mem_addr[4:2] == 3'd0);
        number_write <= of_console & (mem_addr[4:2] == 3'd1);
        end_write <= of_console & (mem_addr[4:2] == 3'd2);
        grain_write <= of_console & (mem_addr[4:2] == 3'd3);
        lit_write <= of_console & (mem_addr[4:2] == 3'd4);
        written <= mem_wdata;
    end

    assign mem_ready = ram_ready | shade_ack | grain_ack | shade_ready | grain_ready | lit_ready |
                       console_ready;
    assign mem_rdata = shade_ack ? shade_rdata : grain_ack ? grain_rdata : ram_rdata;
endmodule

`default_nettype wire
