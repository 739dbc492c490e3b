                if (${ output.name }$ !== ${ output.select }$) begin
                    ${ names.errors }$ = ${ names.errors }$ + 1;
                    if (${ names.errors }$ <= REPORTED)
                        $display("clock %0d, word %0d %0s: ${ output.name }$ is %h, expected %h",
                            ${ names.clock }$, ${ address }$,
                            ${ names.word_name }$(${ address }$),
                            ${ output.name }$, ${ output.select }$);
                end
