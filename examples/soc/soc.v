// A system on a chip that shades: PicoRV32, 64 kB of RAM, and two cores of Glint on Wishbone.
//
//  0x0000_0000  RAM, with the program
//  0x1000_0000  the registers of `shade`, cosine-power
//  0x2000_0000  +0 a byte of the picture of `shade`, +4 a number to print, +8 the end, with an exit code, +12 a byte of
//               the picture of `grain`
//  0x3000_0000  the registers of `grain`, rough

`default_nettype none

module soc (
    input  wire        clk,
    input  wire        rst_n,
    output reg         shade_write,
    output reg         grain_write,
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

    picorv32 #(
        .BARREL_SHIFTER(1),
        .ENABLE_FAST_MUL(1),
        .ENABLE_DIV(1),
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
        .pcpi_valid(),
        .pcpi_insn(),
        .pcpi_rs1(),
        .pcpi_rs2(),
        .pcpi_wr(1'b0),
        .pcpi_rd(32'd0),
        .pcpi_wait(1'b0),
        .pcpi_ready(1'b0),
        .irq(32'd0),
        .eoi(),
        .trace_valid(),
        .trace_data()
    );

    // RAM answers in the first clock of a request: it is asked a clock ahead.
    reg  [31:0] ram [0:16383];
    initial $readmemh("firmware.hex", ram);
    reg         ram_ready;
    reg  [31:0] ram_rdata;
    wire        la_ram = mem_la_addr[31:28] == 4'd0;
    wire [13:0] la_at = mem_la_addr[15:2];
    always @(posedge clk) begin
        ram_ready <= rst_n & la_ram & (mem_la_read | mem_la_write);
        if (mem_la_read) ram_rdata <= ram[la_at];
        if (mem_la_write & la_ram) begin
            if (mem_la_wstrb[0]) ram[la_at][7:0] <= mem_la_wdata[7:0];
            if (mem_la_wstrb[1]) ram[la_at][15:8] <= mem_la_wdata[15:8];
            if (mem_la_wstrb[2]) ram[la_at][23:16] <= mem_la_wdata[23:16];
            if (mem_la_wstrb[3]) ram[la_at][31:24] <= mem_la_wdata[31:24];
        end
    end

    // The cores, which are asked a clock ahead too, and then until they answer.
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

    // To the outside.
    wire of_console = mem_valid & (mem_addr[31:28] == 4'd2) & ~console_ready;
    reg  console_ready;
    always @(posedge clk) begin
        console_ready <= rst_n & of_console;
        shade_write <= of_console & (mem_addr[3:2] == 2'd0);
        grain_write <= of_console & (mem_addr[3:2] == 2'd3);
        number_write <= of_console & (mem_addr[3:2] == 2'd1);
        end_write <= of_console & (mem_addr[3:2] == 2'd2);
        written <= mem_wdata;
    end

    assign mem_ready = ram_ready | shade_ack | grain_ack | console_ready;
    assign mem_rdata = shade_ack ? shade_rdata : grain_ack ? grain_rdata : ram_rdata;
endmodule

`default_nettype wire
