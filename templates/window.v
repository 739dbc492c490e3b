// ${ name }$: runs ${ bench }$ and records the waveform of clocks ${ from }$ to ${ to }$ in ${ file }$

`default_nettype none

module ${ name }$;
    ${ bench }$ bench ();

    initial begin
        #${ begin }$;
        $dumpfile("${ file }$");
        $dumpvars(0, bench);
        #${ length }$;
        $display("FAIL ${ name }$: the window ends");
        $finish;
    end
endmodule

`default_nettype wire
